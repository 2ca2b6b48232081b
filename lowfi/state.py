"""The state vector: the slot of each quantity, and the motion of a body.

Each body has place r, velocity v, quaternion q, spin h in body axes, and the *total* angular
momentum A about the scene origin::

    h = I w,      A = r x m v + R h      (h and w in body axes)

Explicit Runge-Kutta methods conserve linear invariants to rounding. The sums of m v and of A over
both bodies, minus the impulse and its moment from outside, are such invariants if every internal
force acts as a pair at one common point; a wrong pair still shows. The rate follows from h. From A
it would be w = I^-1 R' (A - r x m v): an error of R would turn a large spin into one about the axis
of least inertia, where it is a large rate. ``reconcile`` makes h and R agree with A after each
step.

Bodies that are *apart* have A about their own mass centres, A = R h: with rails at rest from ignition
on, and two free bodies after the exit. Of a payload that is far away under thrust, r x m v is so much
larger than R h that its error would be an error of the rate.

The work entries come next. They are quadratures of the same method, so both ledgers close to its
accuracy. The modes of the rails, if there are any, come last (``lowfi.contact.compliant.modes``).
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import entry, kernel
from tipoff.mechanics import comoving
from tipoff.mechanics.model import Model

# Offsets inside a body's slots.
PLACE, VELOCITY, QUATERNION, SPIN, BODY_SIZE = 0, 3, 6, 10, 13
# First slots of the parts of the state.
PAYLOAD, PLATFORM, MOMENT, IMPULSE, TURN, WORK = 0, 13, 26, 32, 35, 38
# The first slots of each body and of its A.
BODIES = ((PAYLOAD, MOMENT), (PLATFORM, MOMENT + 3))
DYNAMIC_SIZE = 26  # slots on which the equations of motion depend, besides modes
MOVING_SIZE = 32  # the same plus A of both bodies
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
_REGULAR = 1e-13  # of the trace; keeps the matrix of ``reconcile`` regular
# WORK + WORK_SIZE, padded to whole cache lines: rows of stages are read as vectors of eight
STATE_SIZE = 48


class Motion(NamedTuple):
    """Motion of a body at one instant, in scene axes except for ``body_rate``."""

    place: tuple  # m, mass centre
    velocity: tuple  # m/s, of the mass centre
    turn: tuple  # nine numbers of the rotation matrix
    rate: tuple  # rad/s, angular velocity
    body_rate: tuple  # rad/s, angular velocity in body axes


@kernel
def copy(source, target, size):
    """Copy the first ``size`` numbers. A loop, because a slice would compile Numba's broadcasting
    and its error texts into each kernel."""
    for j in range(size):
        target[j] = source[j]


@kernel
def modal_size(compliance):
    """Number of values that the modes of ``compliance`` add to the state: all amplitudes q (kg^0.5
    m), rail by rail, then all their rates."""
    size = 0
    if compliance is not None:
        size = _modal_size(compliance.modes)
    return size


@kernel
def _modal_size(modes):
    size = 0
    if modes.square.size > 0:
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
    """Three numbers from slot ``first``."""
    return (values[first], values[first + 1], values[first + 2])


@kernel
def moment_of(body):
    """First slot of A of the body whose slots begin at ``body``."""
    return MOMENT if body == PAYLOAD else MOMENT + 3


@kernel
def quaternion(state, body):
    """Quaternion of the body whose slots begin at ``body``."""
    first = body + QUATERNION
    return (state[first], state[first + 1], state[first + 2], state[first + 3])


@kernel
def motion(record, state, body):
    """Motion of the body of ``record`` whose slots begin at ``body``."""
    turn = rotation.matrix(quaternion(state, body))
    rate = _rate(record, triple(state, body + SPIN))
    return Motion(
        triple(state, body + PLACE),
        triple(state, body + VELOCITY),
        turn,
        rotation.rotate(turn, rate),
        rate,
    )


@kernel
def _rate(record, h):
    """Body rate (rad/s) of spin ``h``, refined once. The inverse inertia of a thin body that lies
    across its axes has large numbers; their rounding couples the axes. After the refinement only an
    error about the thin axis remains, which does not accelerate the body."""
    w = rotation.multiply(record.inverse_inertia, h)
    back = rotation.multiply(record.inertia, w)
    more = rotation.multiply(
        record.inverse_inertia, (h[0] - back[0], h[1] - back[1], h[2] - back[2])
    )
    return (w[0] + more[0], w[1] + more[1], w[2] + more[2])


@kernel
def frame(platform, state):
    """Motion of the frame that carries the rails: the platform, or the scene axes at rest."""
    if platform.free:
        return motion(platform, state, PLATFORM)
    zero = (0.0, 0.0, 0.0)
    return Motion(zero, zero, (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), zero, zero)


@kernel
def velocity_at(body, point):
    """Velocity (m/s) of the point of a body that is at ``point``."""
    arm = (point[0] - body.place[0], point[1] - body.place[1], point[2] - body.place[2])
    swing = rotation.cross(body.rate, arm)
    return (body.velocity[0] + swing[0], body.velocity[1] + swing[1], body.velocity[2] + swing[2])


@kernel
def kinetic(mass, state, first, body):
    """Kinetic energy (J) of the body whose slots begin at ``first``, in the motion ``body``."""
    turning = rotation.dot(triple(state, first + SPIN), body.body_rate)
    return 0.5 * (mass * rotation.dot(body.velocity, body.velocity) + turning)


@kernel
def normalise(state):
    """Bring both quaternions back to length one."""
    for body in (PAYLOAD, PLATFORM):
        _set_quaternion(state, body, quaternion(state, body))


@kernel
def _set_quaternion(state, body, q):
    unit = rotation.normalised(q)
    for i in range(4):
        state[body + QUATERNION + i] = unit[i]


@kernel
def orbit(mass, apart, state, body):
    """The part r x m v (kg m2/s) of A of the body of ``mass`` (kg) whose slots begin at ``body``: zero if
    the bodies are ``apart``."""
    if apart:
        return (0.0, 0.0, 0.0)
    place, v = triple(state, body + PLACE), triple(state, body + VELOCITY)
    return rotation.cross(place, (mass * v[0], mass * v[1], mass * v[2]))


@kernel
def take_apart(mass, state, body):
    """Refer A of the body whose slots begin at ``body`` to its mass centre. The moment from outside
    changes as much, so that their balance holds."""
    carry(state, body, orbit(mass, False, state, body))


@kernel
def carry(values, body, moment):
    """Take the ``moment`` of m v, or of its derivative, about the origin from A of the body whose slots
    begin at ``body``, and from the moment from outside."""
    for i in range(3):
        values[moment_of(body) + i] -= moment[i]
        values[TURN + i] -= moment[i]


@kernel
def reconcile(record, apart, dt, state, body):
    """Make attitude and spin of a body, whose slots begin at ``body``, agree with its A, to first
    order, at the end of a step of ``dt`` (s); ``apart``: A is about its mass centre.

    The difference e = R' (A - r x m v) - h is an error of the step. Turns p of the body (rad, body
    axes) and changes d of its spin with d = e + h x p remove it. The pair that changes rates least
    is used. The minimum of |p|^2 / dt^2 + |I^-1 d|^2 is at::

        p = dt^2 h x k,      (I^2 + dt^2 (|h|^2 - h h')) k = e
    """
    h = triple(state, body + SPIN)
    q, a = quaternion(state, body), triple(state, moment_of(body))
    carried = orbit(record.mass, apart, state, body)
    spin = rotation.unrotate(
        rotation.matrix(q), (a[0] - carried[0], a[1] - carried[1], a[2] - carried[2])
    )
    e = (spin[0] - h[0], spin[1] - h[1], spin[2] - h[2])
    g = (dt * h[0], dt * h[1], dt * h[2])
    k = rotation.solve(
        _squares(record.inertia, g, (1.0, 0.0, 0.0)),
        _squares(record.inertia, g, (0.0, 1.0, 0.0)),
        _squares(record.inertia, g, (0.0, 0.0, 1.0)),
        e,
    )
    p = rotation.cross((dt * g[0], dt * g[1], dt * g[2]), k)
    left = rotation.cross(h, p)
    for i in range(3):
        state[body + SPIN + i] += e[i] + left[i]
    turned = rotation.product(q, (1.0, 0.5 * p[0], 0.5 * p[1], 0.5 * p[2]))
    _set_quaternion(state, body, turned)


@kernel
def _squares(inertia, g, k):
    """(I^2 + |g|^2 - g g') k, plus a small part of the trace, so that the sum is regular to
    rounding for the thinnest body."""
    square = rotation.multiply(inertia, rotation.multiply(inertia, k))
    trace = 2.0 * rotation.dot(g, g)
    for i in range(3):
        for j in range(3):
            trace += inertia[i, j] * inertia[i, j]
    size, along = rotation.dot(g, g) + _REGULAR * trace, rotation.dot(g, k)
    return (
        square[0] + size * k[0] - along * g[0],
        square[1] + size * k[1] - along * g[1],
        square[2] + size * k[2] - along * g[2],
    )


def initial(model: Model) -> np.ndarray:
    """State (STATE_SIZE,) at ignition, in the frame of ``mechanics.comoving``."""
    state, first = np.zeros(STATE_SIZE), model.initial
    payload, platform = model.payload, model.platform
    start = comoving.start(model)
    fill(
        state,
        PAYLOAD,
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
            platform.inertia,
            tuple(start.platform_place),
            tuple(start.platform_velocity),
            (1.0, 0.0, 0.0, 0.0),
            first.platform_rate,
        )
        put_together(payload.mass, platform.mass, state)
    return state


@entry
def fill(state, body, inertia, place, velocity, attitude, rate):
    """Fill the slots of a body that is apart from others, the first of which is ``body``, and those of its A
    in ``state`` (STATE_SIZE,): inertia (3,3) kg m2 in body axes, place (m), velocity (m/s), unit
    quaternion and rate (rad/s) in body axes."""
    moment, h = moment_of(body), rotation.multiply(inertia, rate)
    spin = rotation.rotate(rotation.matrix(attitude), h)
    for i in range(3):
        state[body + PLACE + i], state[body + VELOCITY + i] = place[i], velocity[i]
        state[body + SPIN + i] = h[i]
        state[moment + i] = spin[i]
    for i in range(4):
        state[body + QUATERNION + i] = attitude[i]


@entry
def put_together(mass, platform_mass, state):
    """Refer A of payload and platform, of these masses (kg), to the origin."""
    for body, m in ((PAYLOAD, mass), (PLATFORM, platform_mass)):
        carried = orbit(m, False, state, body)
        for i in range(3):
            state[moment_of(body) + i] += carried[i]
