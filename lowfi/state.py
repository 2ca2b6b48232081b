"""The state vector: the slot of each quantity, and the motion of a body.

Each body has place r, velocity v, quaternion q and the *total* angular momentum about the scene
origin::

    A = r x m v + h,      h = R I R' w,      w = R I^-1 R' (A - r x m v)

Explicit Runge-Kutta methods conserve linear invariants to rounding. The sums of m v and of A over
both bodies, less the impulse and its moment from outside, are such invariants when every internal
force acts as a pair at one common point; a wrong pair still shows. The work entries after them are
quadratures: the same method integrates them, so both ledgers close to its accuracy. The modes of
the rails come last, where there are any (``lowfi.contact.compliant.modes``).
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import entry, kernel
from tipoff.mechanics import comoving
from tipoff.mechanics.model import Model

# Offsets inside a body's slots.
PLACE, VELOCITY, QUATERNION, MOMENT, BODY_SIZE = 0, 3, 6, 10, 13
# First slots of the parts of the state.
PAYLOAD, PLATFORM, IMPULSE, TURN, WORK = 0, 13, 26, 29, 32
DYNAMIC_SIZE = 26  # what the equations of motion depend on, besides modes
# Slots of work and loss (J), total and axial part.
(
    THRUST,
    THRUST_AXIAL,
    BODY_FORCE,
    BODY_FORCE_AXIAL,
    FRICTION,
    FRICTION_AXIAL,
    DAMPING,
    RELEASED,
    CONTACT_AXIAL,
    STRUCTURAL,
) = range(WORK, WORK + 10)
WORK_SIZE = 10
# WORK + WORK_SIZE, filled up to whole cache lines: rows of stages are read as vectors of eight
STATE_SIZE = 48


class Motion(NamedTuple):
    """Motion of a body at one instant, in scene axes."""

    place: tuple  # m, mass centre
    velocity: tuple  # m/s, of the mass centre
    turn: tuple  # nine numbers of the rotation matrix
    rate: tuple  # rad/s, angular velocity


@kernel
def copy(source, target, size):
    """Copy the first ``size`` numbers. A loop, because a slice brings Numba's broadcasting and its
    error texts into each kernel."""
    for j in range(size):
        target[j] = source[j]


@kernel
def modal_size(compliance):
    """How many numbers the modes of ``compliance`` add to the state: all amplitudes q (kg^0.5 m),
    rail by rail, then all their rates."""
    size = 0
    if compliance is not None:
        size = _modal_size(compliance.modes)
    return size


@kernel
def _modal_size(modes):
    size = 0
    if modes is not None:
        size = 2 * modes.square.size
    return size


@kernel
def copy_all(source, target, modal):
    """Copy a state with ``modal`` numbers of modes after it."""
    copy(source, target, STATE_SIZE)
    for j in range(STATE_SIZE, STATE_SIZE + modal):
        target[j] = source[j]


@kernel
def triple(values, first):
    """Three numbers from slot ``first`` on."""
    return (values[first], values[first + 1], values[first + 2])


@kernel
def quaternion(state, body):
    """Quaternion of the body whose slots begin at ``body``."""
    first = body + QUATERNION
    return (state[first], state[first + 1], state[first + 2], state[first + 3])


@kernel
def motion(mass, inverse_inertia, state, body):
    """Motion of the body whose slots begin at ``body``."""
    place, velocity = triple(state, body + PLACE), triple(state, body + VELOCITY)
    turn = rotation.matrix(quaternion(state, body))
    moment, orbit = triple(state, body + MOMENT), rotation.cross(place, velocity)
    spin = (moment[0] - mass * orbit[0], moment[1] - mass * orbit[1], moment[2] - mass * orbit[2])
    return Motion(place, velocity, turn, rotation.angular_velocity(turn, inverse_inertia, spin))


@kernel
def frame(platform, state):
    """Motion of the frame that carries the rails: the platform, or the scene axes at rest."""
    if platform is not None:
        return motion(platform.mass, platform.inverse_inertia, state, PLATFORM)
    zero = (0.0, 0.0, 0.0)
    return Motion(zero, zero, (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), zero)


@kernel
def velocity_at(body, point):
    """Velocity (m/s) of the point of a body that is now at ``point``."""
    arm = (point[0] - body.place[0], point[1] - body.place[1], point[2] - body.place[2])
    swing = rotation.cross(body.rate, arm)
    return (body.velocity[0] + swing[0], body.velocity[1] + swing[1], body.velocity[2] + swing[2])


@kernel
def normalise(state):
    """Bring both quaternions back to length one."""
    for body in (PAYLOAD, PLATFORM):
        first = body + QUATERNION
        q = rotation.normalised(quaternion(state, body))
        for i in range(4):
            state[first + i] = q[i]


def initial(model: Model) -> np.ndarray:
    """State (STATE_SIZE,) at ignition, in the frame of ``mechanics.comoving``."""
    state, first = np.zeros(STATE_SIZE), model.initial
    payload, platform = model.payload, model.platform
    start = comoving.start(model)
    fill(
        state,
        PAYLOAD,
        payload.mass,
        payload.inertia,
        tuple(start.place),
        tuple(start.velocity),
        rotation.exponential(first.attitude),
        first.rate,
    )
    state[PLATFORM + QUATERNION] = 1.0
    if platform is not None:
        fill(
            state,
            PLATFORM,
            platform.mass,
            platform.inertia,
            tuple(start.platform_place),
            tuple(start.platform_velocity),
            (1.0, 0.0, 0.0, 0.0),
            first.platform_rate,
        )
    return state


@entry
def fill(state, body, mass, inertia, place, velocity, attitude, rate):
    """Fill the slots of a body, the first of which is ``body``, in ``state`` (STATE_SIZE,): mass
    (kg), inertia (3,3) kg m2 in body axes, place (m), velocity (m/s), unit quaternion and rate
    (rad/s) in body axes."""
    orbit, turn, j = rotation.cross(place, velocity), rotation.matrix(attitude), inertia
    spin = rotation.rotate(
        turn,
        (
            j[0, 0] * rate[0] + j[0, 1] * rate[1] + j[0, 2] * rate[2],
            j[1, 0] * rate[0] + j[1, 1] * rate[1] + j[1, 2] * rate[2],
            j[2, 0] * rate[0] + j[2, 1] * rate[1] + j[2, 2] * rate[2],
        ),
    )
    for i in range(3):
        state[body + PLACE + i], state[body + VELOCITY + i] = place[i], velocity[i]
        state[body + MOMENT + i] = mass * orbit[i] + spin[i]
    for i in range(4):
        state[body + QUATERNION + i] = attitude[i]
