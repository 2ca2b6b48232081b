"""Closed forms of free and thrust rigid bodies. SI units; rates in body axes."""

import math

import numpy as np
from scipy.special import ellipj, ellipk, fresnel


def free_rates(inertia: tuple, start: tuple, time: np.ndarray) -> np.ndarray:
    """Rates (n,3) of a free body with I1 < I2 < I3 started at (w1, 0, w3) with energy above the
    separatrix, 2 T I2 < L^2: (w1 cn, w2 sn, w3 dn) of lambda t (Whittaker, Analytical Dynamics,
    section 69; Jacobi)."""
    rate, parameter, middle = _jacobi(inertia, start)
    sn, cn, dn, _ = ellipj(rate * np.asarray(time), parameter)
    return np.stack([start[0] * cn, middle * sn, start[2] * dn], axis=-1)


def free_period(inertia: tuple, start: tuple) -> float:
    """Period (s) of the rates, 4 K(m) / lambda."""
    rate, parameter, _ = _jacobi(inertia, start)
    return 4.0 * float(ellipk(parameter)) / rate


def _jacobi(inertia, start):
    i1, i2, i3 = inertia
    w1, _, w3 = start
    energy = i1 * w1**2 + i3 * w3**2
    square = (i1 * w1) ** 2 + (i3 * w3) ** 2
    rate = math.sqrt((i3 - i2) * (square - energy * i1) / (i1 * i2 * i3))
    parameter = (i2 - i1) * (energy * i3 - square) / ((i3 - i2) * (square - energy * i1))
    middle = math.copysign(math.sqrt((energy * i3 - square) / (i2 * (i3 - i2))), w1 * w3)
    return rate, parameter, middle


def flip_times(inertia: tuple, start: tuple) -> tuple[float, float]:
    """First zero (s) of w2 and the time between zeros, 2 K(m) / lambda, of a body with I1 < I2 < I3
    started at (0, w2, w3) near its middle axis with L^2 > 2 T I2. w2 starts at its largest, so the
    first zero is at K(m) / lambda."""
    i1, i2, i3 = inertia
    energy = sum(i * w * w for i, w in zip(inertia, start))
    square = sum((i * w) ** 2 for i, w in zip(inertia, start))
    rate = math.sqrt((i3 - i2) * (square - energy * i1) / (i1 * i2 * i3))
    parameter = (i2 - i1) * (energy * i3 - square) / ((i3 - i2) * (square - energy * i1))
    quarter = float(ellipk(parameter)) / rate
    return quarter, 2.0 * quarter


def axisymmetric(
    axial: float, transverse: float, spin: float, wobble: float
) -> tuple[float, float, float]:
    """Rate (rad/s) of the transverse rate as seen in the body, of the axis in space, and cone
    half-angle (rad): (Ia - It) w / It, H / It, atan(It w_t / (Ia w)) (Goldstein, Classical
    Mechanics, section 5.6)."""
    momentum = math.hypot(axial * spin, transverse * wobble)
    return (
        (axial - transverse) * spin / transverse,
        momentum / transverse,
        math.atan2(transverse * wobble, axial * spin),
    )


def planar_thrust(
    force: float, arm: float, mass: float, inertia: float, time: float
) -> tuple[float, float, float]:
    """Rate (rad/s) and velocity (m/s) of a body pushed along its own axis at a constant offset
    ``arm`` from rest: v = (F/m) sqrt(pi/a) (C, S)(t sqrt(a/pi)), a = F r / I (Fresnel integrals;
    Abramowitz and Stegun 7.3)."""
    a = force * arm / inertia
    sine, cosine = fresnel(time * math.sqrt(a / math.pi))
    scale = force / mass * math.sqrt(math.pi / a)
    return a * time, scale * cosine, scale * sine


def impulsive_rate(inertia: np.ndarray, arm: np.ndarray, impulse: np.ndarray) -> np.ndarray:
    """Rate (3,) after an impulse (N s) at ``arm`` (m) from the mass centre: I^-1 (r x J)."""
    return np.linalg.solve(inertia, np.cross(arm, impulse))


def recoil(
    impulse: float, payload: float, platform: float, inertia: float, offset: float
) -> dict[str, float]:
    """Speeds (m/s), rate (rad/s), closing speed on the line and energy (J) after an impulse between
    a payload and a free platform whose mass centre lies ``offset`` (m) beside the line: J/m, -J/M,
    -J b/I."""
    v, base, rate = impulse / payload, -impulse / platform, -impulse * offset / inertia
    return {
        "payload": v,
        "platform": base,
        "rate": rate,
        "closing": v - base - rate * offset,
        "energy": 0.5 * (payload * v**2 + platform * base**2 + inertia * rate**2),
    }


def elastic_impact(mass: float, other: float, v: float) -> tuple[float, float]:
    """Speeds (m/s) of a body at ``v`` and of ``other`` (kg) at rest after an impact without loss: v
    (m - M)/(m + M), 2 v m/(m + M) (momentum and energy)."""
    return v * (mass - other) / (mass + other), 2.0 * v * mass / (mass + other)
