"""Closed forms of bodies between two walls or on an edge. SI units, angles in rad."""

import math

from scipy.integrate import quad


def jam_offset(mu: float, span: float) -> float:
    """Offset (m) of a push at which a slider guided over ``span`` (m) without clearance locks: s /
    (2 mu) (the drawer that sticks; moments give two pad forces of F r / s, so friction takes 2 mu F
    r / s)."""
    return span / (2.0 * mu)


def net_share(mu: float, offset: float, span: float) -> float:
    """Share of a push, or of its impulse, that moves such a slider: 1 - 2 mu r / s."""
    return 1.0 - 2.0 * mu * offset / span


def crossing_the_clearance(
    clearance: float, span: float, couple: float, inertia: float
) -> dict[str, float]:
    """A body centred between two walls, turned by a couple (N m) until two pads ``span`` (m) apart
    touch: angle 2c/s, time sqrt(2 I theta / M), rate sqrt(2 M theta / I) and pad speed (constant
    angular acceleration)."""
    angle = 2.0 * clearance / span
    rate = math.sqrt(2.0 * couple * angle / inertia)
    return {
        "angle": angle,
        "time": math.sqrt(2.0 * inertia * angle / couple),
        "rate": rate,
        "pad_speed": 0.5 * span * rate,
    }


def tip_off(
    mass: float, inertia: float, arm: float, span: float, speed: float, g: float
) -> dict[str, float]:
    """A body that leaves a rail at ``speed`` (m/s) turns about its rear pad, ``arm`` (m) behind the
    mass centre, while that pad covers ``span`` (m): angular acceleration m g a / (I + m a^2), rate,
    angle (small) and rear load (N) (moments about the pad)."""
    turning = mass * g * arm / (inertia + mass * arm**2)
    time = span / speed
    return {
        "acceleration": turning,
        "rate": turning * time,
        "angle": 0.5 * turning * time**2,
        "load": mass * g * inertia / (inertia + mass * arm**2),
    }


def rocking_rate(
    half_width: float, half_height: float, start: float, angle: float, g: float
) -> float:
    """Rate (rad/s) at ``angle`` (rad) of a block that rocks about one edge, released at rest at
    ``start``: sqrt(2 p^2 [cos(a - t0) - cos(a - t)]), p^2 = 3 g / 4 R (Housner, Bull. Seism. Soc.
    Am. 53, 1963)."""
    tipping, radius = math.atan2(half_width, half_height), math.hypot(half_width, half_height)
    return math.sqrt(1.5 * g / radius * (math.cos(tipping - start) - math.cos(tipping - angle)))


def rocking_time(half_width: float, half_height: float, start: float, g: float) -> float:
    """Time (s) until that block stands upright; with t = t0 (1 - u^2) the integrand is smooth."""

    def slowness(u):
        return (
            2.0 * start * u / rocking_rate(half_width, half_height, start, start * (1.0 - u * u), g)
        )

    return quad(slowness, 0.0, 1.0, epsabs=1e-12)[0]
