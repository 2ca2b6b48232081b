"""What the coefficient of friction of the reference scene moves: settled rates of compliant contact
at other coefficients."""

import numpy as np

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import lowfi

CONDITION = "phi35"


def rates(coefficient: float) -> np.ndarray:
    """Settled rates (3,) deg/s of the reference scene at a coefficient of friction."""
    changed = REFERENCE.condition(CONDITION).replace(
        {"friction.static": coefficient, "friction.dynamic": coefficient}
    )
    run = lowfi.run(changed, "compliant", compliance=reference_compliance())
    return np.degrees(run.outcome.rate)


def ours(at: list[float]) -> dict[str, list[float]]:
    """Largest change of a settled rate (deg/s) from the scene's coefficient to those of ``at``."""
    start = rates(REFERENCE.friction.static)
    return {"change of a settled rate": [float(np.abs(rates(mu) - start).max()) for mu in at]}
