"""A force per mass that acts on every body and is uniform in space and time: ``F = m a``.

Solvers know only this record, not the effects from which it comes.
"""

from typing import NamedTuple

from tipoff.kernels.jit import njit


class BodyForce(NamedTuple):
    """Kernel record: acceleration in inertial axes."""

    x: float  # m/s2
    y: float  # m/s2
    z: float  # m/s2


@njit
def acceleration(force):
    """Acceleration (m/s2) as a tuple; zero if ``force`` is None."""
    if force is not None:
        return (force.x, force.y, force.z)
    return (0.0, 0.0, 0.0)
