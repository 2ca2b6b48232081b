"""Spring pushers of the reference: their forces at each step, their kicks, their work and their
energy.

The forces belong to the places of step n, and friction to the velocities of n - 1/2. In the step in
which the stroke of a pusher is used up, at a share q of the drift, the force acts over q steps. Half
a step of it is already in the kick before. So the next kick has the rest, and the last velocity
does not depend on where in a step the stroke ends::

    F = q (F_n + F_end) / 2 - F_n / 2          friction f (q - 1/2)
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.state.pose import body_rate, triple
from tipoff.highfi.state.records import AXIAL, TOTAL, Pushing
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.scenes.effects import pusher_law as law


class Arm(NamedTuple):
    """Point of a pusher and the direction of its force, in inertial axes."""

    direction: tuple  # unit vector
    on_payload: tuple  # m, from the mass centre of the payload
    on_platform: tuple  # m, from the mass centre of the rigid part


def new_state(pushers: law.Pushers | None) -> Pushing | None:
    """Values before the first evaluation."""
    if pushers is None:
        return None
    count = len(pushers.point)
    return Pushing(
        segment=np.full(count, -1),
        travel=np.zeros(count),
        force=np.zeros(count),
        friction=np.zeros(count),
        begun=np.zeros(1),
    )


@inlined
def begin_pushers(pushers, frame, state, pose):
    """Forces at ignition, at the first call only."""
    if pushers is not None:
        pushing = state.pushing
        for i in range(pushing.segment.size):
            if pushing.segment[i] < 0:
                s = law.travel(pushers, i, pose.centre, pose.turn)
                segment = law.segment_at(pushers, i, s)
                pushing.segment[i], pushing.travel[i] = segment, s
                pushing.begun[0] += law.given_up(pushers, i, segment, s)
                speed = _speed(pushers, i, frame, state, pose)
                pushing.force[i] = law.force(pushers, i, segment, s)
                pushing.friction[i] = law.friction(pushers, i, segment, speed)


@inlined
def load_pushers(pushers, frame, state, pose):
    """Forces at the places that a step has reached."""
    if pushers is not None:
        for i in range(state.pushing.segment.size):
            _load(pushers, i, frame, state, pose)


@kernel
def _load(pushers, i, frame, state, pose):
    pushing, last = state.pushing, law.last_segment(pushers, i)
    before, s = pushing.travel[i], law.travel(pushers, i, pose.centre, pose.turn)
    pushing.travel[i] = s
    if pushing.segment[i] == last:
        pushing.force[i] = pushing.friction[i] = 0.0
        return
    speed = _speed(pushers, i, frame, state, pose)
    segment = law.segment_at(pushers, i, s)
    if segment == last:
        stroke = pushers.travel[pushers.first[i] + last]
        share = (stroke - before) / (s - before)
        end = law.force(pushers, i, last - 1, stroke)
        held = law.friction(pushers, i, last - 1, speed)
        pushing.force[i] = 0.5 * (share * (pushing.force[i] + end) - pushing.force[i])
        pushing.friction[i] = (share - 0.5) * held
    else:
        pushing.force[i] = law.force(pushers, i, segment, s)
        pushing.friction[i] = law.friction(pushers, i, segment, speed)
    pushing.segment[i] = segment


@kernel
def _arm(pushers, i, frame, state, pose):
    arm = rotation.rotate(pose.turn, law.point_of(pushers, i))
    out = rotation.rotate(pose.frame, arm)
    base = out
    if frame is not None:
        p, b = state.payload.position, state.platform.position
        base = (out[0] + p[0] - b[0], out[1] + p[1] - b[1], out[2] + p[2] - b[2])
    return Arm(rotation.rotate(pose.frame, pushers.direction), out, base)


@kernel
def _speed(pushers, i, frame, state, pose):
    """Speed (m/s) of the travel of pusher ``i``."""
    arm = _arm(pushers, i, frame, state, pose)
    there = _along(
        arm.direction,
        arm.on_payload,
        triple(state.payload.velocity),
        rotation.rotate(pose.frame, pose.rate),
    )
    return there - _speed_of_platform(frame, state, arm)


@kernel
def _speed_of_platform(frame, state, arm):
    speed = 0.0
    if frame is not None:
        rate = body_rate(state.platform, frame.inverse_inertia)
        velocity = triple(state.platform.velocity)
        speed = _along(arm.direction, arm.on_platform, velocity, rate)
    return speed


@kernel
def _along(direction, arm, velocity, rate):
    return rotation.dot(direction, velocity) + rotation.dot(direction, rotation.cross(rate, arm))


@inlined
def kick_pushers(pushers, constants, state, pose, dt):
    """Advance the velocities of the bodies over ``dt`` by the pushers; adds the external impulse."""
    if pushers is not None:
        for i in range(state.pushing.segment.size):
            size = dt * (state.pushing.force[i] - state.pushing.friction[i])
            if size != 0.0:
                _kick(constants, state, _arm(pushers, i, constants.frame, state, pose), size)


@kernel
def _kick(constants, state, arm, size):
    """``size``: impulse (N s)."""
    d, body = arm.direction, state.payload
    push = (size * d[0], size * d[1], size * d[2])
    turn = rotation.cross(arm.on_payload, push)
    for i in range(3):
        body.velocity[i] += push[i] / constants.payload.mass
        body.spin[i] += turn[i]
    _kick_back(constants.frame, state, arm, push)


@kernel
def _kick_back(frame, state, arm, push):
    if frame is not None:
        turn = rotation.cross(arm.on_platform, push)
        for i in range(3):
            state.platform.velocity[i] -= push[i] / frame.mass
            state.platform.spin[i] -= turn[i]
    if frame is None:
        p, out = state.payload.position, arm.on_payload
        point = (p[0] + out[0], p[1] + out[1], p[2] + out[2])
        turn = rotation.cross(point, push)
        for i in range(3):
            state.impulse[i] += push[i]
            state.impulse[3 + i] += turn[i]


@inlined
def work_of_pushers(pushers, frame, state, pose, axial_speed, half):
    """Add the work of all pushers over ``half`` a step (s) at the velocities of ``pose``.
    ``axial_speed`` (m/s): X velocity of the payload's mass centre relative to the platform's."""
    if pushers is not None:
        total, axial = state.work[TOTAL], state.work[AXIAL]
        along = rotation.rotate(pose.frame, pushers.direction)[0] * axial_speed
        for i in range(state.pushing.segment.size):
            speed = _speed(pushers, i, frame, state, pose)
            force, held = half * state.pushing.force[i], half * state.pushing.friction[i]
            total.thrust += force * speed
            axial.thrust += force * along
            total.friction += held * speed
            axial.friction += held * along


def work(pushers: law.Pushers, pushing: Pushing) -> float:
    """Energy (J) that the pushers have given up since ignition, by their potential."""
    return law.energy_given_up(pushers, pushing.segment, pushing.travel) - float(pushing.begun[0])
