"""Compute the change of rate in drop tests, its uncertainty, and its rank among simulated cases.

Writes droptest.json, all signals to droptest.nc, and figures.

A log is a CSV file with time and three rates; accelerations and temperature are optional. Its
sheet is a .toml file in the same folder with units, axes, calibration and uncertainties.
studies/droptest/logs/ has three examples. The arguments are the sheets:

  tipoff droptest test1.toml test2.toml test3.toml

The simulated cases have the random errors of the scene, or those of the paper where it states none.
--vary replaces them:

  tipoff droptest test1.toml --scene my_launcher.toml --vary my_errors.toml --condition heavy

The logs of the package are simulated by a sensor model. All results mark them as simulated.
"""

from tipoff.studies.droptest.options import Options
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Drop tests", "Drop tests", Options)
