"""Compare measured logs with simulated cases: drop tests and launches from a rail.

Writes measured.json, CSV tables, and figures; for drop tests all signals to measured.nc, for each launch its
thrust less friction as measured-thrust-N.csv.

A log is a CSV file with time and three rates; accelerations and temperature are optional. Its
sheet is a .toml file in the same folder with units, axes, calibration and uncertainties.
studies/measured/logs/ has three examples. The arguments are the sheets:

  tipoff measured test1.toml test2.toml test3.toml

A sheet with the table \\[launch] is of a launch from rest on a rail. The scene has its rail, gravity and thrust:

  tipoff measured flight.toml --scene my_launcher.toml --vary my_errors.toml

The simulated cases have the random errors of the scene, or those of the paper where it states none.
--vary replaces them.

The logs of the package are simulated by a sensor model. All results mark them as simulated.
"""

from tipoff.studies.measured.options import MeasuredOptions
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Measured logs", "Measured logs", MeasuredOptions)
