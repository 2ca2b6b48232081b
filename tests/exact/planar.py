"""A body in a vertical plane that slides off the end of level rails, on flat elastic pads."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class Launch(NamedTuple):
    """SI units. The pads are ``arm`` ahead of and behind the mass centre and ``drop`` below it; all
    pads at one place together are ``length`` long and ``width`` wide."""

    mass: float
    inertia: float
    arm: float
    drop: float
    length: float
    width: float
    stiffness: float  # N/m3
    gravity: float
    rail_end: float  # of X
    start: float  # X of the mass centre
    speed: float


def tip_off(launch: Launch, duration: float, strips: int = 400) -> np.ndarray:
    """X, height, angle (nose down), and their rates (6,) after ``duration`` (s), from rest across
    the rail.

    The foot of each pad is a row of springs, and what of it is beyond the rail end has none. With
    the energy E(x, z, angle) of all springs the forces are -dE/dx, -dE/dz and -dE/dangle: the springs
    left behind push the pad on.
    """
    foot = launch.length * ((np.arange(strips) + 0.5) / strips - 0.5)
    size = launch.length / strips
    area = launch.length * launch.width
    sunk = launch.mass * launch.gravity / (2.0 * launch.stiffness * area)

    def loads(x, z, angle):
        force = np.zeros(3)
        for along in (launch.arm, -launch.arm):
            a, b = along + foot, -launch.drop
            aside = np.cos(angle) * a + np.sin(angle) * b
            depth = np.maximum(0.0, -launch.drop - z + np.sin(angle) * a - np.cos(angle) * b)
            over = np.clip((launch.rail_end - x - aside) / size + 0.5, 0.0, 1.0)
            up = launch.stiffness * launch.width * size * depth * over
            on = 0.5 * launch.stiffness * launch.width * depth**2 * ((over > 0.0) & (over < 1.0))
            lever = -np.sin(angle) * a + np.cos(angle) * b
            force += on.sum(), up.sum(), (lever * on - aside * up).sum()
        return force

    def rates(_, state):
        x, z, angle, *speeds = state
        force = loads(x, z, angle)
        return [
            *speeds,
            force[0] / launch.mass,
            force[1] / launch.mass - launch.gravity,
            force[2] / launch.inertia,
        ]

    start = [launch.start, -sunk, 0.0, launch.speed, 0.0, 0.0]
    found = solve_ivp(rates, [0.0, duration], start, rtol=1e-8, atol=1e-12, max_step=1e-4)
    return found.y[:, -1]
