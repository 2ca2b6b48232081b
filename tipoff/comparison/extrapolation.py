"""Discretisation uncertainty of a value from grids, coarsest first, by the observed order.

    f(h) = f_0 + a h^p,   e32 / e21 = r21^p (r32^p - 1) / (r21^p - 1)      gives the observed order p
    U = F |e21| / (r21^p - 1)                              the finest value f_1 is within U of f_0

with e21 = f_2 - f_1, e32 = f_3 - f_2, r21 = h_2 / h_1, r32 = h_3 / h_2. The last change e21 is no
estimate: at first order and r21 = 2 the error is as large, at order 1/2 it is 2.4 times that.

======================================  =====================  ====================================
three values                            order used             F
======================================  =====================  ====================================
0.5 <= p <= order of the method         p                      1.25
p above the order of the method         that of the method     3
0 < p < 0.5                             0.5                    3
changes of alternating sign that fall   1                      3
last change zero, or almost             1                      3
changes that do not fall                none: not converged    3 times the range of the three values
======================================  =====================  ====================================

If the last change is smaller than the order of the method predicts from the change before, this is
a coincidence: F is then 3, and e21 is replaced by the predicted change.

Two values show no order. The first order is assumed, as at the edge of a clamped strip, where the
stress is singular, and F is 3. Sources: Roache, J. Fluids Eng. 116 (1994) 405, the grid convergence
index with 1.25 for three grids and 3 for two; ASME V&V 20-2009, section 2-4; Oberkampf and Roy,
Verification and Validation in Scientific Computing, Cambridge 2010, the limits of the order; Eca
and Hoekstra, J. Comput. Phys. 262 (2014) 104, a bound by the range.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import scipy  # its parts load when they are first used

SAFETY_FACTOR = 1.25
CAUTIOUS_FACTOR = 3.0
METHOD_ORDER = 2.0  # central differences in time, displacements of the elements
_ASSUMED_ORDER = 1.0
_LEAST_ORDER = 0.5
_STEEPEST = 60.0  # a larger order comes from a difference of almost zero
_FEWEST = 2
NOT_CONVERGED = "not converged: changes do not fall"


@dataclass(frozen=True)
class Estimate:
    """Result of ``estimate``."""

    order: float | None  # observed
    uncertainty: float | None  # of the finest value, in its unit; None if unknown
    gci_percent: float | None  # the same in per cent of the value
    method: str  # its name


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float | None:
    """Order p of three values on grids of three decreasing ``sizes``; negative if differences grow,
    None if the values are not monotone or the order is too large to find. Raises ValueError for other sizes."""
    (r32, r21), (e32, e21) = _ratios(sizes), (values[0] - values[1], values[1] - values[2])
    if e32 * e21 <= 0.0:
        return None

    def miss(order: float) -> float:
        slopes = math.expm1(order * math.log(r21)), math.expm1(order * math.log(r32))
        unequal = slopes[0] / slopes[1] if order else math.log(r21) / math.log(r32)
        return math.log(e32 / e21) + math.log(unequal) - order * math.log(r21)

    if miss(-_STEEPEST) < 0.0 or miss(_STEEPEST) > 0.0:
        return None
    return float(scipy.optimize.brentq(miss, -_STEEPEST, _STEEPEST, xtol=1e-12))


def estimate(sizes: Sequence[float], values: Sequence[float | None]) -> Estimate:
    """Uncertainty of the last of the ``values``, from the three finest grids or from two; None is a
    run that did not settle."""
    sizes, finest = sizes[-3:], [value for value in values[-3:] if value is not None]
    if len(finest) < len(values[-3:]):
        return Estimate(None, None, None, "a run did not settle")
    if len(finest) < _FEWEST:
        return Estimate(None, None, None, "one grid: not known")
    if max(finest) == min(finest):
        return _estimate(None, 0.0, finest, "no change at all")
    if len(finest) == _FEWEST:
        error = _error(sizes[0] / sizes[1], finest, _ASSUMED_ORDER)
        return _estimate(None, CAUTIOUS_FACTOR * error, finest, "two values: first order, factor 3")
    return _of_three(sizes, finest)


def _of_three(sizes: Sequence[float], values: Sequence[float]) -> Estimate:
    order = observed_order(sizes, values)
    if not _falls(values, order):
        bound = CAUTIOUS_FACTOR * (max(values) - min(values))
        return _estimate(order, bound, values, NOT_CONVERGED)
    change = abs(values[1] - values[2])
    if order is None:
        change = max(change, _least_change(sizes, values))
        is_monotone = (values[0] - values[1]) * (values[1] - values[2]) >= 0.0
        words = "last change almost zero" if is_monotone else "alternating"
        used, factor, method = _ASSUMED_ORDER, CAUTIOUS_FACTOR, f"{words}: first order, factor 3"
    elif _LEAST_ORDER <= order <= METHOD_ORDER + 1e-6:
        used, factor, method = min(order, METHOD_ORDER), SAFETY_FACTOR, "GCI"
    else:
        change = max(change, _least_change(sizes, values))
        used = min(max(order, _LEAST_ORDER), METHOD_ORDER)
        factor, method = CAUTIOUS_FACTOR, f"GCI, order limited to {used:g}, factor 3"
    return _estimate(order, factor * change / (_ratios(sizes)[1] ** used - 1.0), values, method)


def _least_change(sizes: Sequence[float], values: Sequence[float]) -> float:
    """The last change that the order of the method predicts from the first."""
    coarse, fine = (ratio**METHOD_ORDER - 1.0 for ratio in _ratios(sizes))
    return abs(values[0] - values[1]) * fine / (coarse * (fine + 1.0))


def _falls(values: Sequence[float], order: float | None) -> bool:
    """Whether the second change is smaller than the first; with an ``order``, as the power of the
    size requires."""
    if order is not None:
        return order > 0.0
    return abs(values[1] - values[2]) < abs(values[0] - values[1])


def _estimate(
    order: float | None, uncertainty: float, values: Sequence[float], method: str
) -> Estimate:
    return Estimate(
        order, uncertainty, 100.0 * uncertainty / abs(values[-1]) if values[-1] else None, method
    )


def _error(ratio: float, values: Sequence[float], order: float) -> float:
    """Error of the last value; its grid is ``ratio`` times finer than the one before."""
    return abs(values[-2] - values[-1]) / (ratio**order - 1.0)


def _ratios(sizes: Sequence[float]) -> tuple[float, float]:
    """h_3 / h_2 and h_2 / h_1."""
    if not (len(sizes) == 3 and sizes[0] > sizes[1] > sizes[2] > 0.0):
        raise ValueError(f"need three falling sizes above zero, got {tuple(sizes)}")
    return sizes[0] / sizes[1], sizes[1] / sizes[2]
