"""Records of absent effects, of the types of present ones, and the tests by which a kernel skips them
at run time. So one compiled kernel serves scenes with any effects."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.pushers import Pushers
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.mechanics.laws.thrust_offset import ThrustOffset

NO_FORCE = BodyForce(x=0.0, y=0.0, z=0.0)
NO_DAMPING = Damping(mass_rate=0.0, stiffness_time=0.0)
NO_LATCH = HoldDown(release=-np.inf, line=(0.0, 0.0), is_stop=False)
SMOOTH = Friction(static=0.0, dynamic=0.0, static_speed=1.0, dynamic_speed=2.0)  # no friction
NO_PUSHERS = Pushers(
    direction=np.zeros((0, 3)),
    point=np.zeros((0, 3)),
    origin=np.zeros(0),
    first=np.zeros(1, dtype=np.int64),
    travel=np.zeros(0),
    force=np.zeros(0),
    energy=np.zeros(0),
    friction=np.zeros(0),
    mass=np.zeros(0),
)


class Offset(NamedTuple):
    """Line of action of the thrust, in body axes."""

    acts: bool  # else the line is along the body's x axis through the mass centre
    direction: tuple  # unit vector
    arm: tuple  # m, from the actual mass centre


def offset(thrust_offset: ThrustOffset | None) -> Offset:
    """The line of action of a thrust."""
    if thrust_offset is None:
        return Offset(False, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return Offset(True, *thrust_offset)


@kernel
def rubs(friction):
    """Whether there is two-step friction."""
    return friction.static > 0.0 or friction.dynamic > 0.0


@kernel
def pulls(force):
    """Whether there is a body force."""
    return force.x != 0.0 or force.y != 0.0 or force.z != 0.0


@kernel
def damps(damping):
    """Whether rails have structural damping."""
    return damping.mass_rate > 0.0 or damping.stiffness_time > 0.0
