"""Discretisation uncertainty of a value, from three grids, coarsest first.

    f(h) = f_0 + a h^p,   e32 / e21 = r21^p (r32^p - 1) / (r21^p - 1)      gives the observed order p
    GCI = F |e21 / f_1| / (r21^p - 1),   F = 1.25                          the finest value is within GCI of f_0

with f_1 the finest value, e21 = f_2 - f_1, e32 = f_3 - f_2, r21 = h_2 / h_1, r32 = h_3 / h_2.
Sources: Roache, J. Fluids Eng. 116 (1994) 405; ASME V&V 20-2009, section 2-4. Where three values
show no order (not monotone, or an order below 0.5) the uncertainty is three times half their range;
the order is limited to that of the method: Eca and Hoekstra, J. Comput. Phys. 262 (2014) 104,
section 3.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.optimize import brentq

SAFETY_FACTOR = 1.25
METHOD_ORDER = 2.0  # central differences in time, displacements of the elements
_LEAST_ORDER = 0.5
_RANGE_FACTOR = 3.0
_GRIDS = 3
_STEEPEST = 60.0  # an order beyond this is a difference that vanished


@dataclass(frozen=True)
class Estimate:
    """Observed ``order`` or None, ``uncertainty`` of the finest value in its own unit, ``gci_percent``,
    the same in per cent of that value (or None), and the ``method`` by name."""

    order: float | None
    uncertainty: float | None
    gci_percent: float | None
    method: str


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float | None:
    """Order p of three values on grids of three falling ``sizes``; negative where differences grow,
    None where the values do not go one way. Raises ValueError for other sizes."""
    (r32, r21), (e32, e21) = _ratios(sizes), (values[0] - values[1], values[1] - values[2])
    if e32 * e21 <= 0.0:
        return None

    def miss(order: float) -> float:
        slopes = math.expm1(order * math.log(r21)), math.expm1(order * math.log(r32))
        unequal = slopes[0] / slopes[1] if order else math.log(r21) / math.log(r32)
        return math.log(e32 / e21) + math.log(unequal) - order * math.log(r21)

    if miss(-_STEEPEST) < 0.0 or miss(_STEEPEST) > 0.0:
        return None
    return float(brentq(miss, -_STEEPEST, _STEEPEST, xtol=1e-12))


def grid_convergence_index(sizes: Sequence[float], values: Sequence[float], order: float) -> float:
    """GCI of the finest of three values on grids of three falling ``sizes``, as a fraction of
    it."""
    return abs(_uncertainty(sizes, values, order) / values[2])


def extrapolated(sizes: Sequence[float], values: Sequence[float], order: float) -> float:
    """Richardson's value for an infinitely fine grid."""
    return values[2] + (values[2] - values[1]) / (_ratios(sizes)[1] ** order - 1.0)


def estimate(sizes: Sequence[float], values: Sequence[float | None]) -> Estimate:
    """Uncertainty of the last of the ``values``, from the three finest grids; None stands for a run
    that did not settle."""
    sizes, finest = sizes[-3:], [value for value in values[-3:] if value is not None]
    if len(finest) < len(values[-3:]):
        return Estimate(None, None, None, "a run did not settle")
    if len(finest) < _GRIDS:
        return Estimate(None, None, None, "not known from fewer than three grids")
    if max(finest) == min(finest):
        return _estimate(None, 0.0, finest, "no change at all")
    order = observed_order(sizes, finest)
    if order is None or order < _LEAST_ORDER:
        why = "not monotone" if order is None else f"order below {_LEAST_ORDER:g}"
        return _estimate(
            order,
            _RANGE_FACTOR * 0.5 * (max(finest) - min(finest)),
            finest,
            f"{why}: three times half the range",
        )
    if order > METHOD_ORDER:
        return _estimate(
            order,
            _uncertainty(sizes, finest, METHOD_ORDER),
            finest,
            f"GCI, order limited to {METHOD_ORDER:g}",
        )
    return _estimate(order, _uncertainty(sizes, finest, order), finest, "GCI")


def _estimate(
    order: float | None, uncertainty: float, values: Sequence[float], method: str
) -> Estimate:
    return Estimate(
        order, uncertainty, 100.0 * uncertainty / abs(values[-1]) if values[-1] else None, method
    )


def _uncertainty(sizes, values, order: float) -> float:
    return SAFETY_FACTOR * abs(extrapolated(sizes, values, order) - values[2])


def _ratios(sizes: Sequence[float]) -> tuple[float, float]:
    """h_3 / h_2 and h_2 / h_1."""
    if not (len(sizes) == 3 and sizes[0] > sizes[1] > sizes[2] > 0.0):
        raise ValueError(f"need three falling sizes above zero, got {tuple(sizes)}")
    return sizes[0] / sizes[1], sizes[1] / sizes[2]
