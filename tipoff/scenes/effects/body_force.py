"""A force per mass that acts on every body and is uniform in space and time: ``F = m a``.

Solvers know this record only, and not the effects that it comes from.
"""

from typing import NamedTuple

from tipoff.kernels.jit import njit


class BodyForce(NamedTuple):
    """Kernel record: force per mass, which is an acceleration, in inertial axes (m/s2)."""

    x: float
    y: float
    z: float


@njit
def acceleration(force):
    """Acceleration (m/s2) as a tuple; zero where ``force`` is None."""
    if force is not None:
        return (force.x, force.y, force.z)
    return (0.0, 0.0, 0.0)
