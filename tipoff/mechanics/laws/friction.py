"""Two-step Coulomb friction with static and dynamic coefficients and transition speeds (the law of
ADAMS/Solver CONTACT).

With s = |v| the sliding speed, v_s the static and v_d the dynamic transition speed::

    mu(s) = mu_s (3 r - r^3) / 2,  r = s / v_s                      s <= v_s
    mu(s) = mu_s + (mu_d - mu_s) x^2 (3 - 2 x),  x = (s - v_s)/(v_d - v_s)   v_s < s < v_d
    mu(s) = mu_d                                                    s >= v_d

The first branch is the cubic step from -mu_s at -v_s to mu_s at v_s. The force is ``-mu(s) N v/s``.
"""

from typing import NamedTuple

from tipoff.kernels.jit import njit


class Friction(NamedTuple):
    """Kernel record of the two-step Coulomb law."""

    static: float  # coefficient
    dynamic: float  # coefficient
    static_speed: float  # m/s
    dynamic_speed: float  # m/s


@njit
def coefficient_over_speed(friction, speed):
    """mu(s)/s (s/m) at sliding speed ``speed`` >= 0 (m/s); finite at rest, where the slip has no
    direction."""
    if speed <= friction.static_speed:
        ratio = speed / friction.static_speed
        return 0.5 * friction.static * (3.0 - ratio * ratio) / friction.static_speed
    if speed >= friction.dynamic_speed:
        return friction.dynamic / speed
    x = (speed - friction.static_speed) / (friction.dynamic_speed - friction.static_speed)
    return (
        friction.static + (friction.dynamic - friction.static) * x * x * (3.0 - 2.0 * x)
    ) / speed
