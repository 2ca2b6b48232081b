"""Simpler integrators, used only as controls: fixed-step Runge-Kutta of order four, semi-implicit
and explicit Euler.

All solve x'' = a(t, x, v) for one coordinate, or an array of coordinates, with a constant step.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

X = TypeVar("X", float, np.ndarray)
Acceleration = Callable[[float, X, X], X]


def runge_kutta(acceleration: Acceleration[X], x: X, v: X, step: float, count: int) -> tuple[X, X]:
    """Position and velocity after ``count`` steps of the classical Runge-Kutta method."""
    for n in range(count):
        t = n * step
        a1 = acceleration(t, x, v)
        x2, v2 = x + 0.5 * step * v, v + 0.5 * step * a1
        a2 = acceleration(t + 0.5 * step, x2, v2)
        x3, v3 = x + 0.5 * step * v2, v + 0.5 * step * a2
        a3 = acceleration(t + 0.5 * step, x3, v3)
        x4, v4 = x + step * v3, v + step * a3
        a4 = acceleration(t + step, x4, v4)
        x = x + step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        v = v + step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
    return x, v


def semi_implicit_euler(
    acceleration: Acceleration[X], x: X, v: X, step: float, count: int
) -> tuple[X, X]:
    """Velocity first, then position with the new velocity."""
    for n in range(count):
        v = v + step * acceleration(n * step, x, v)
        x = x + step * v
    return x, v


def explicit_euler(
    acceleration: Acceleration[X], x: X, v: X, step: float, count: int
) -> tuple[X, X]:
    """Position and velocity from the old state."""
    for n in range(count):
        x, v = x + step * v, v + step * acceleration(n * step, x, v)
    return x, v
