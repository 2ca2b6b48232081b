"""Reference curves to surrogate constants, with what the curves cannot tell said beside them."""

from calibrate.curves import Curves
from calibrate.faults import CalibrationError
from calibrate.posterior import posterior
from calibrate.posterior_record import Posterior, disturbed, draws
from calibrate.run import run

__all__ = ["CalibrationError", "Curves", "Posterior", "disturbed", "draws", "posterior", "run"]
