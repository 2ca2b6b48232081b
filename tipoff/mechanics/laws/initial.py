"""Initial state of payload and platform at ignition.

Position is the displacement of the payload from its centred place; attitude is a rotation vector
(axis times angle) from scene axes to body axes. Velocities are inertial, in scene axes; rates are
in the body's own axes.
"""

from typing import NamedTuple


class Initial(NamedTuple):
    """Plain record of the initial state."""

    position: tuple = (0.0, 0.0, 0.0)  # m
    attitude: tuple = (0.0, 0.0, 0.0)  # rad, rotation vector
    velocity: tuple = (0.0, 0.0, 0.0)  # m/s
    rate: tuple = (0.0, 0.0, 0.0)  # rad/s
    platform_velocity: tuple = (0.0, 0.0, 0.0)  # m/s
    platform_rate: tuple = (0.0, 0.0, 0.0)  # rad/s
    settled: bool = False  # whether the payload rests on its rails
