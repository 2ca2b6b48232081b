"""Pose of the payload in frame axes, and the drift of bodies and frame over one step.

With R the frame's rotation, w = R' x_dot a node's inertial velocity in frame axes, v the velocity
of the mass centre of the rigid part, from which X is measured here, and Q = R(n+1)' R(n), the exact
free drift x(n+1) = x(n) + dt x_dot is in frame axes::

    X + u(n+1) = Q [X + u(n) + dt (w - R' v)],       w(n+1) = Q w(n)

Every inertial term (linear, Euler, Coriolis, centrifugal) is contained in these two lines; the
expansion Q = 1 - dt [omega x] gives the usual four. Linear and angular momentum of the whole system
are kept to round-off, because a drift does not change them.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel


class Pose(NamedTuple):
    """The payload in frame axes, and the frame's own rotation."""

    turn: tuple  # (9,) rotation of the payload
    centre: tuple  # (3,) m, its mass centre
    velocity: tuple  # (3,) m/s
    rate: tuple  # (3,) rad/s
    frame: tuple  # (9,) rotation of the frame to inertial axes


@kernel
def triple(a):
    """The first three numbers of an array."""
    return (a[0], a[1], a[2])


@kernel
def plus(a, b):
    """a + b of two triples."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def less(a, b):
    """a - b of two triples."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def body_matrix(body):
    """Rotation matrix (nine numbers) of a body, to inertial axes."""
    q = body.quaternion
    return rotation.matrix((q[0], q[1], q[2], q[3]))


@kernel
def body_rate(body, inverse_inertia):
    """Angular velocity in inertial axes (rad/s)."""
    return rotation.angular_velocity(body_matrix(body), inverse_inertia, triple(body.spin))


@kernel
def _identity():
    return (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@kernel
def frame_matrix(platform_state, frame):
    """Rotation of the frame; the identity, without computation, if the platform is fixed."""
    turn = _identity()
    if frame.free:
        turn = body_matrix(platform_state)
    return turn


@kernel
def _from_origin(separation, frame):
    """Convert a place in frame axes from the mass centre of the rigid part to the frame's
    origin."""
    place = separation
    if frame.free:
        c = frame.centre
        place = (separation[0] + c[0], separation[1] + c[1], separation[2] + c[2])
    return place


@kernel
def origin_of_frame(frame, platform, base):
    """Place (m) of the frame's origin in inertial axes; ``base``: rotation of the frame."""
    place = triple(platform.position)
    if frame.free:
        place = less(place, rotation.rotate(base, triple(frame.centre)))
    return place


@kernel
def pose_in_frame(state, payload, frame):
    """Pose of the payload at this instant, with the velocities of the half step."""
    base = frame_matrix(state.platform, frame)
    turn = body_matrix(state.payload)
    relative = _transpose_product(base, turn)
    separation = (
        state.payload.position[0] - state.platform.position[0],
        state.payload.position[1] - state.platform.position[1],
        state.payload.position[2] - state.platform.position[2],
    )
    rate = rotation.angular_velocity(turn, payload.inverse_inertia, triple(state.payload.spin))
    return Pose(
        turn=relative,
        centre=_from_origin(rotation.unrotate(base, separation), frame),
        velocity=rotation.unrotate(base, triple(state.payload.velocity)),
        rate=rotation.unrotate(base, rate),
        frame=base,
    )


@kernel
def _transpose_product(a, b):
    """A' B of two rotation matrices."""
    c0 = rotation.unrotate(a, (b[0], b[3], b[6]))
    c1 = rotation.unrotate(a, (b[1], b[4], b[7]))
    c2 = rotation.unrotate(a, (b[2], b[5], b[8]))
    return (c0[0], c1[0], c2[0], c0[1], c1[1], c2[1], c0[2], c1[2], c2[2])


@kernel
def drift_body(body, inverse_inertia, dt):
    """Free motion of a rigid body over ``dt``: spin constant, orientation by the midpoint rule
    (second order)."""
    q = (body.quaternion[0], body.quaternion[1], body.quaternion[2], body.quaternion[3])
    spin = triple(body.spin)
    start = rotation.angular_velocity(rotation.matrix(q), inverse_inertia, spin)
    middle = rotation.step(q, start, 0.5 * dt)
    rate = rotation.angular_velocity(rotation.matrix(middle), inverse_inertia, spin)
    end = rotation.step(q, rate, dt)
    for i in range(4):
        body.quaternion[i] = end[i]
    for i in range(3):
        body.position[i] += dt * body.velocity[i]
    return rate


@kernel
def small_turn(rate, dt):
    """Q - 1 (nine numbers) for a frame that turns at ``rate`` (rad/s, frame axes) over ``dt``,
    without cancellation."""
    x, y, z = -dt * rate[0], -dt * rate[1], -dt * rate[2]
    square = x * x + y * y + z * z
    # sin(a)/a and (1 - cos a)/a^2; a step turns the frame by 1e-8 rad, so two terms are exact.
    angle = np.sqrt(square)
    a = 1.0 - square / 6.0 if angle < 1e-3 else np.sin(angle) / angle
    b = 0.5 - square / 24.0 if angle < 1e-3 else (1.0 - np.cos(angle)) / square
    return (
        -b * (y * y + z * z),
        b * x * y - a * z,
        b * x * z + a * y,
        b * x * y + a * z,
        -b * (x * x + z * z),
        b * y * z - a * x,
        b * x * z - a * y,
        b * y * z + a * x,
        -b * (x * x + y * y),
    )
