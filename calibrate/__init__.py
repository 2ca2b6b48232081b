"""The contact of the surrogate from the finite elements: rail compliance from statics, constants of
springs from curves."""

from calibrate.curves import Curves
from calibrate.faults import CalibrationError
from calibrate.rail_compliance import compliance
from calibrate.run import run

__all__ = ["CalibrationError", "Curves", "compliance", "run"]
