"""The inertia of spring pushers: the pairs of forces that accelerate them (``pusher_law``).

The relative acceleration of the payload at a point x, along the direction e that turns with the platform,
is that of the speed of travel::

    d2s/dt2 = e . (a_payload(x) - a_platform(x) - 2 Omega x v_relative)
"""

from typing import NamedTuple

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.step_limit import mobility
from tipoff.lowfi.pushers import place_of, slip_at
from tipoff.lowfi.system import Body
from tipoff.mechanics.laws import pushers as law


class Moving(NamedTuple):
    """Mass of the payload, and accelerations of payload and platform: linear (m/s2) and angular
    (rad/s2), in scene axes."""

    record: Body
    payload: tuple
    platform: tuple


@kernel
def resist(inertia, mass, pushing, payload, bodies, state, out):
    """Fill the pairs of forces (N) that accelerate the pushers, with the other forces in ``out``."""
    moving = Moving(
        payload,
        accelerations(payload, state, slot.PAYLOAD, bodies.payload, out),
        of_platform(bodies.platform, state, bodies.base, out),
    )
    for i in range(mass.size):
        inertia.pairs[i] = 0.0
        for j in range(mass.size):
            inertia.matrix[i, j] = 1.0 if i == j else 0.0
        if pushing.segment[i] != law.last_segment(pushing.law, i):
            _balance(inertia, mass[i], pushing, i, bodies, moving)
    law.solve(inertia.matrix, inertia.pairs)


@kernel
def _balance(inertia, mass, pushing, i, bodies, moving):
    """Fill row ``i`` of the equations."""
    body, base, platform, payload = bodies.payload, bodies.base, bodies.platform, moving.record
    e, x = (
        rotation.rotate(base.turn, law.direction_of(pushing.law, i)),
        place_of(pushing, i, body),
    )
    slip = slip_at(body, base, x)
    there = acceleration(body, moving.payload, x)
    here = acceleration(base, moving.platform, x)
    turning = rotation.cross(base.rate, slip)
    relative = (
        there[0] - here[0] - 2.0 * turning[0],
        there[1] - here[1] - 2.0 * turning[1],
        there[2] - here[2] - 2.0 * turning[2],
    )
    inertia.pairs[i] = mass * rotation.dot(e, relative)
    for j in range(inertia.pairs.size):
        if pushing.segment[j] != law.last_segment(pushing.law, j):
            d, y = (
                rotation.rotate(base.turn, law.direction_of(pushing.law, j)),
                place_of(pushing, j, body),
            )
            inertia.matrix[i, j] += mass * mobility(platform, payload, body, base, (e, x), (d, y))


@kernel
def acceleration(body, moving, point):
    """Acceleration (m/s2) of the matter of a body at a ``point``."""
    arm = (point[0] - body.place[0], point[1] - body.place[1], point[2] - body.place[2])
    inward = rotation.cross(body.rate, rotation.cross(body.rate, arm))
    turned = rotation.cross(moving[1], arm)
    return (
        moving[0][0] + turned[0] + inward[0],
        moving[0][1] + turned[1] + inward[1],
        moving[0][2] + turned[2] + inward[2],
    )


@kernel
def accelerations(record, state, first, body, out):
    """Acceleration (m/s2) of the mass centre, and angular acceleration (rad/s2) in scene axes, by
    the forces in ``out``."""
    force = slot.triple(out, first + slot.VELOCITY)
    moment, carried = slot.triple(out, slot.moment_of(first)), rotation.cross(body.place, force)
    about_centre = rotation.unrotate(
        body.turn, (moment[0] - carried[0], moment[1] - carried[1], moment[2] - carried[2])
    )
    gyroscopic = rotation.cross(slot.triple(state, first + slot.SPIN), body.body_rate)
    spinning = (
        about_centre[0] + gyroscopic[0],
        about_centre[1] + gyroscopic[1],
        about_centre[2] + gyroscopic[2],
    )
    turning = rotation.rotate(body.turn, rotation.multiply(record.inverse_inertia, spinning))
    mass = record.mass
    return (force[0] / mass, force[1] / mass, force[2] / mass), turning


@kernel
def of_platform(platform, state, base, out):
    moving = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    if platform.free:
        moving = accelerations(platform, state, slot.PLATFORM, base, out)
    return moving
