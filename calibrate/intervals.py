"""Intervals of fitted parameters, from the information matrix J'J and the sum r'r of the squared
residuals.

    s^2 = r'r / (n - p)        V = s^2 (J'J)^-1        half width  t(0.975; n - p) sqrt(V_ii)

This is the linear theory of least squares (Seber and Wild, Nonlinear Regression, 1989, section
5.1). ``n`` counts independent residuals: a curve of n samples counts as n / tau, tau the
correlation time of its residuals in samples (``calibration.correlation``).

A parameter with a component in a weak direction has an infinite interval. Model error counts as
scatter here. It also shifts the constants, and these intervals do not contain that shift.
"""

from collections.abc import Sequence

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration.correlation import correlation_time
from tipoff.calibration.information import ROUNDING

LEVEL = 0.95
# least component of a unit vector for which a parameter belongs to a direction, as in
# ``information.combination``
PART = 0.1


def deviations(
    matrix: np.ndarray, variance: float, unobserved: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """Standard deviations (p,) of parameters with the information ``matrix`` (p,p) from residuals
    of this ``variance``.

    Infinite for parameters with a component in a direction without information, or in one of
    ``unobserved``, unit vectors (p,).
    """
    values, vectors = np.linalg.eigh(matrix)
    least = ROUNDING * values[-1]
    found = np.sqrt(
        variance * (vectors**2 / np.maximum(values, max(least, np.finfo(float).tiny))).sum(axis=1)
    )
    for direction in [*vectors.T[values <= least], *unobserved]:
        found[np.abs(direction) >= PART] = np.inf
    return found


def half_widths(
    matrix: np.ndarray, squares: float, count: float, unobserved: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """Half widths (p,) of the intervals from the sum of squared residuals and the number of
    independent ones.

    All infinite unless there are more independent residuals than parameters.
    """
    freedom = count - len(matrix)
    if freedom <= 0.0:
        return np.full(len(matrix), np.inf)
    return scipy.stats.t.ppf(0.5 + 0.5 * LEVEL, freedom) * deviations(
        matrix, squares / freedom, unobserved
    )


def independent(curve: np.ndarray) -> float:
    """Number of independent residuals among those of one curve (n,), from 1 to n; 0 for a curve
    without residuals."""
    return curve.size / correlation_time([curve]) if curve.any() else 0.0
