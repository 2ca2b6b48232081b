"""Reference curves to surrogate constants, with what the curves cannot tell said beside them."""

from calibrate.curves import Curves
from calibrate.faults import CalibrationError
from calibrate.run import run

__all__ = ["CalibrationError", "Curves", "run"]
