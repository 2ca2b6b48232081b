"""Spring pushers of the reference: their forces at each step, their kicks, their work and their
energy.

The forces belong to the places of step n, and friction to the velocities of n - 1/2. In the step in
which the stroke of a pusher is used up, at a share q of the drift, the force acts over q steps. Half
a step of it is already in the kick before. So the next kick has the rest, and the last velocity
does not depend on where in a step the stroke ends::

    F = q (F_n + F_end) / 2 - F_n / 2          friction f (q - 1/2)

Pushers with mass m take from each kick the pairs of impulses m (new - old) of the speeds of their travel,
after all other impulses (``pusher_law``). Of the last kick they resist their own force, and a share q - 1/2
of all others.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.state.pose import body_matrix, body_rate, triple
from tipoff.highfi.state.records import AXIAL, PUSHERS, TOTAL, Inertia, Pushing
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics.laws import pushers as law

SPEED, GAINED, FORCE, SHARE = range(4)  # rows of ``Inertia.values``


class Arm(NamedTuple):
    """Point of a pusher and the direction of its force, in inertial axes."""

    direction: tuple  # unit vector
    on_payload: tuple  # m, from the mass centre of the payload
    on_platform: tuple  # m, from the mass centre of the rigid part


def new_state(pushers: law.Pushers) -> Pushing:
    """Values before the first evaluation."""
    count = len(pushers.point)
    return Pushing(
        segment=np.full(count, -1),
        travel=np.zeros(count),
        force=np.zeros(count),
        friction=np.zeros(count),
        begun=np.zeros(1),
        inertia=_inertia(pushers.mass.size),
    )


def _inertia(count: int) -> Inertia:
    return Inertia(
        values=np.zeros((4, count)),
        kept=np.zeros(count),
        matrix=np.zeros((count, count)),
        pairs=np.zeros(count),
    )


@inlined
def begin_pushers(pushers, frame, state, pose):
    """Forces at ignition, at the first call only."""
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
            _begin_inertia(pushing.inertia, i, speed, segment == law.last_segment(pushers, i))


@kernel
def _begin_inertia(inertia, i, speed, is_off):
    if inertia.pairs.size > 0:
        inertia.values[SPEED, i] = np.nan if is_off else speed
        inertia.values[SHARE, i] = 1.0


@inlined
def load_pushers(pushers, frame, state, pose):
    """Forces at the places that a step has reached."""
    for i in range(state.pushing.segment.size):
        state.evaluated[PUSHERS] += 1
        _load(pushers, i, frame, state, pose)


@kernel
def _load(pushers, i, frame, state, pose):
    pushing, last = state.pushing, law.last_segment(pushers, i)
    before, s = pushing.travel[i], law.travel(pushers, i, pose.centre, pose.turn)
    pushing.travel[i] = s
    if pushing.segment[i] == last:
        pushing.force[i] = pushing.friction[i] = 0.0
        _stop(pushing.inertia, pushers.mass, i)
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
        _share(pushing.inertia, i, share - 0.5)
    else:
        pushing.force[i] = law.force(pushers, i, segment, s)
        pushing.friction[i] = law.friction(pushers, i, segment, speed)
    pushing.segment[i] = segment


@kernel
def _share(inertia, i, share):
    if inertia.pairs.size > 0:
        inertia.values[SHARE, i] = share


@kernel
def _stop(inertia, mass, i):
    """Keep the kinetic energy of a pusher at its stop."""
    if inertia.pairs.size > 0:
        speed = inertia.values[SPEED, i]
        if speed == speed:
            inertia.kept[i] = 0.5 * mass[i] * speed * speed
            inertia.values[SPEED, i] = np.nan
            inertia.values[GAINED, i] = inertia.values[FORCE, i] = 0.0


@kernel
def _arm(pushers, i, frame, state, pose):
    arm = rotation.rotate(pose.turn, law.point_of(pushers, i))
    out = rotation.rotate(pose.frame, arm)
    base = out
    if frame.free:
        p, b = state.payload.position, state.platform.position
        base = (out[0] + p[0] - b[0], out[1] + p[1] - b[1], out[2] + p[2] - b[2])
    return Arm(rotation.rotate(pose.frame, law.direction_of(pushers, i)), out, base)


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
    if frame.free:
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
    for i in range(state.pushing.segment.size):
        size = dt * (state.pushing.force[i] - state.pushing.friction[i])
        if size != 0.0:
            kick_pair(constants, state, _arm(pushers, i, constants.frame, state, pose), size)
    if pushers.mass.size > 0:
        _resist(state.pushing.inertia, pushers.mass, pushers, constants, state, pose, dt)


@kernel
def _resist(inertia, mass, pushers, constants, state, pose, dt):
    """Kick the bodies by the pairs that change the speeds of the pushers."""
    frame = constants.frame
    for i in range(mass.size):
        inertia.pairs[i] = 0.0
        for j in range(mass.size):
            inertia.matrix[i, j] = 1.0 if i == j else 0.0
        if inertia.values[SPEED, i] == inertia.values[SPEED, i]:
            now = _present_speed(pushers, i, constants, state, pose)
            share, one = inertia.values[SHARE, i], _arm(pushers, i, frame, state, pose)
            own = dt * (state.pushing.force[i] - state.pushing.friction[i])
            own *= mobility(constants, state, one, one)
            gained = own + share * (now - inertia.values[SPEED, i] - own)
            inertia.pairs[i] = mass[i] * gained
            for j in range(mass.size):
                if inertia.values[SPEED, j] == inertia.values[SPEED, j]:
                    other = _arm(pushers, j, frame, state, pose)
                    resisted = mass[i] * mobility(constants, state, one, other)
                    inertia.matrix[i, j] += resisted if i == j else share * resisted
    law.solve(inertia.matrix, inertia.pairs)
    for i in range(mass.size):
        if inertia.values[SPEED, i] == inertia.values[SPEED, i]:
            kick_pair(constants, state, _arm(pushers, i, frame, state, pose), -inertia.pairs[i])
            inertia.values[FORCE, i] = inertia.pairs[i] / dt
            if mass[i] > 0.0:
                inertia.values[GAINED, i] = inertia.pairs[i] / mass[i]
                inertia.values[SPEED, i] += inertia.values[GAINED, i]


@kernel
def _present_speed(pushers, i, constants, state, pose):
    """Speed (m/s) of the travel of pusher ``i`` at the present velocities of the bodies."""
    return present_speed(constants, state, _arm(pushers, i, constants.frame, state, pose))


@kernel
def present_speed(constants, state, arm):
    """Speed (m/s) of the payload relative to the platform along and at an ``arm``."""
    body = state.payload
    rate = body_rate(body, constants.payload.inverse_inertia)
    there = _along(arm.direction, arm.on_payload, triple(body.velocity), rate)
    return there - _speed_of_platform(constants.frame, state, arm)


@kernel
def mobility(constants, state, one, other):
    """Change (1/kg) of the speed of travel at the arm ``one`` by a unit impulse of a pair at the
    ``other``."""
    payload = constants.payload
    turn = rotation.cross(other.on_payload, other.direction)
    turned = rotation.angular_velocity(body_matrix(state.payload), payload.inverse_inertia, turn)
    total = rotation.dot(one.direction, other.direction) / payload.mass
    total += rotation.dot(rotation.cross(one.on_payload, one.direction), turned)
    return total + _mobility_of_platform(constants.frame, state, one, other)


@kernel
def _mobility_of_platform(frame, state, one, other):
    total = 0.0
    if frame.free:
        turn = rotation.cross(other.on_platform, other.direction)
        turned = rotation.angular_velocity(body_matrix(state.platform), frame.inverse_inertia, turn)
        total = rotation.dot(one.direction, other.direction) / frame.mass
        total += rotation.dot(rotation.cross(one.on_platform, one.direction), turned)
    return total


@kernel
def kick_pair(constants, state, arm, size):
    """Kick the bodies by a pair of impulses of ``size`` (N s) at an ``arm``."""
    d, body = arm.direction, state.payload
    push = (size * d[0], size * d[1], size * d[2])
    turn = rotation.cross(arm.on_payload, push)
    for i in range(3):
        body.velocity[i] += push[i] / constants.payload.mass
        body.spin[i] += turn[i]
    _kick_back(constants.frame, state, arm, push)


@kernel
def _kick_back(frame, state, arm, push):
    if frame.free:
        turn = rotation.cross(arm.on_platform, push)
        for i in range(3):
            state.platform.velocity[i] -= push[i] / frame.mass
            state.platform.spin[i] -= turn[i]
    else:
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
    total, axial = state.work[TOTAL], state.work[AXIAL]
    for i in range(state.pushing.segment.size):
        speed = _speed(pushers, i, frame, state, pose)
        along = rotation.rotate(pose.frame, law.direction_of(pushers, i))[0] * axial_speed
        force, held = half * state.pushing.force[i], half * state.pushing.friction[i]
        force -= half * _inertial_force(state.pushing.inertia, i)
        total.thrust += force * speed
        axial.thrust += force * along
        total.friction += held * speed
        axial.friction += held * along


@kernel
def _inertial_force(inertia, i):
    """Force (N) that accelerates pusher ``i``, as in the last kick."""
    force = 0.0
    if inertia.pairs.size > 0:
        force = inertia.values[FORCE, i]
    return force


def work(pushers: law.Pushers, pushing: Pushing) -> float:
    """Work (J) of the pushers since ignition: the energy that they have given up, by their potential,
    less their own kinetic energy."""
    given_up = law.energy_given_up(pushers, pushing.segment, pushing.travel)
    return given_up - float(pushing.begun[0]) - _kinetic(pushers.mass, pushing.inertia)


def _kinetic(mass: np.ndarray, inertia: Inertia) -> float:
    """Kinetic energy (J) that pushers have, or have kept, at the present places."""
    before, gained, *_ = inertia.values
    speed = np.where(np.isfinite(before), before + 0.5 * gained, 0.0)
    return float(inertia.kept.sum() + (0.5 * mass * speed**2).sum())
