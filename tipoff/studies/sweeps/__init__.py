"""Vary size and direction of misalignment, thrust eccentricity and mass eccentricity, up to 1 deg
and 1 mm; writes sweeps.json.

The result states whether the largest rate about each axis stops growing, and at which size, with
an interval. The sweep is repeated with a thrust that continues after the exit, or ends before it. With
--vary, the errors are those of a file, up to the size that 99.9 % of its draws stay below.
"""

from tipoff.studies.question import Question
from tipoff.studies.sweeps.options import Options

QUESTION = Question(__name__, __doc__, "How large an error may be", "Sweeps", Options)
