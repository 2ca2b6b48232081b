"""Contact of the surrogate from the finite elements: rail compliance from statics, and fits of
springs or of parameters of compliant contact to curves."""

from tipoff.calibration.choice import require_parameters
from tipoff.calibration.faults import CalibrationError, require_model
from tipoff.calibration.rail_compliance import compliance
from tipoff.calibration.run import run
from tipoff.calibration.search import Plan
from tipoff.comparison.curves import Curves

__all__ = [
    "CalibrationError",
    "Curves",
    "Plan",
    "compliance",
    "require_model",
    "require_parameters",
    "run",
]
