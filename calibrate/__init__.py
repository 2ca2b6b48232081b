"""The contact of the surrogate from the finite elements: rail compliance from statics, constants of
springs from curves."""

from tipoff.calibration.curves import Curves
from tipoff.calibration.faults import CalibrationError
from tipoff.calibration.rail_compliance import compliance
from tipoff.calibration.run import run

__all__ = ["CalibrationError", "Curves", "compliance", "run"]
