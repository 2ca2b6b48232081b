"""Compare curves of other codes with each other and with tipoff: rates, settled rates, ratings.

Writes curves.json, tables and a figure. The first file is the reference. Each further file, and each
--model of tipoff on --condition, is compared with it: relative L2, settled rates, ISO/TS 18571.

  tipoff curves dyna=rbdout adams=adams.tab --body "dyna: 7" --units "dyna: time=ms, length=mm"
  tipoff curves dyna=binout0000 adams=run.res --condition phi15 --model compliant --model springs

A file is one of: {formats of curves}. It has time from ignition, rate_x, rate_y and rate_z; velocity_x may be
absent. --columns names other columns, and --units gives units that the file does not state.
"""

from tipoff.studies.curves.options import CurvesOptions
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Curves of other codes", "Curves", CurvesOptions)
