"""Closed forms of a block on a rough plane. SI units, angles in rad."""

import math

from scipy.optimize import brentq


def stopping(v: float, mu: float, g: float) -> tuple[float, float]:
    """Distance v^2 / (2 mu g) (m) and time v / (mu g) (s) of a block sliding to rest on a level
    plane (Coulomb)."""
    return v * v / (2.0 * mu * g), v / (mu * g)


def threshold(mu: float) -> float:
    """Slope (rad) above which a block slides: atan mu (Coulomb)."""
    return math.atan(mu)


def sliding_acceleration(angle: float, mu: float, g: float) -> float:
    """Acceleration (m/s2) of a sliding block: g (sin - mu cos)."""
    return g * (math.sin(angle) - mu * math.cos(angle))


def creep_ratio(angle: float, mu: float) -> float:
    """Steady creep over the static transition speed of the cubic step law: root r of mu (3r -
    r^3)/2 = tan(angle) (ADAMS/Solver CONTACT; a smoothed law never sticks)."""
    return brentq(lambda r: 0.5 * mu * (3.0 * r - r**3) - math.tan(angle), 0.0, 1.0, xtol=1e-15)
