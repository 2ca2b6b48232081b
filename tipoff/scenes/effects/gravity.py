"""Uniform gravity: every body is accelerated by g, ``F = m g``. Absent table: no body force."""

from typing import NamedTuple

from tipoff.kernels.jit import njit
from tipoff.scenes.table import Table
from tipoff.scenes.units import Acceleration


class GravityTable(Table):
    """``[gravity]``: acceleration components in initial scene axes (m/s2)."""

    x: Acceleration = 0.0
    y: Acceleration = 0.0
    z: Acceleration = 0.0

    def record(self) -> "Gravity":
        """Kernel record."""
        return Gravity(self.x, self.y, self.z)


class Gravity(NamedTuple):
    """Kernel record: acceleration in inertial axes (m/s2)."""

    x: float
    y: float
    z: float


@njit
def acceleration(gravity):
    """Acceleration (m/s2) as a tuple; zero where the effect is absent."""
    if gravity is not None:
        return (gravity.x, gravity.y, gravity.z)
    return (0.0, 0.0, 0.0)
