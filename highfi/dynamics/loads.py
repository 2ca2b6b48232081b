"""Loads other than contact: thrust, gravity, and the work all of them do.

Work is counted in halves around each kick, ``dt/2 f(n) v(n-1/2)`` before and ``dt/2 f(n) v(n+1/2)``
after: with the kinetic energy ``v(n-1/2) M v(n+1/2) / 2`` the balance of central differences is
then an identity for every force, and the ledgers show only what is not conservative or not smooth.
"""

from tipoff.highfi.contact.pads import friction_power
from tipoff.highfi.state.pose import body_matrix, body_rate, triple
from tipoff.highfi.state.records import (
    CONTACT_AXIAL,
    FRICTION,
    FRICTION_AXIAL,
    FRICTION_FORCE,
    GRAVITY,
    GRAVITY_AXIAL,
    NORMAL_FORCE,
    THRUST,
    THRUST_AXIAL,
)
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.scenes.effects.thrust import magnitude


@kernel
def line_of_action(drive, offset):
    """Thrust direction and arm in body axes; axial through the mass centre when ``offset`` is
    None."""
    line = ((1.0, 0.0, 0.0), (-drive.arm, 0.0, 0.0))
    if offset is not None:
        line = _offset_line(offset)
    return line


@kernel
def _offset_line(offset):
    return offset.direction, offset.arm


@kernel
def thrust_load(state, drive, pulses, curve, offset, time):
    """Thrust force (N), moment about the payload's mass centre (N m) and point of application (m),
    in inertial axes."""
    direction, arm = line_of_action(drive, offset)
    turn = body_matrix(state.payload)
    push = magnitude(pulses, curve, time)
    force = rotation.rotate(turn, (push * direction[0], push * direction[1], push * direction[2]))
    lever = rotation.rotate(turn, arm)
    p = state.payload.position
    return force, rotation.cross(lever, force), (p[0] + lever[0], p[1] + lever[1], p[2] + lever[2])


@kernel
def axial_velocity_of_platform(state, frame, base):
    """Inertial X velocity (m/s) of the mass centre of platform and rails."""
    momentum = rotation.rotate(base, triple(state.rail_momentum))
    return (frame.mass * state.platform.velocity[0] + momentum[0]) / frame.total_mass


@kernel
def add_work(
    rail,
    surface,
    payload,
    frame,
    drive,
    friction,
    gravity,
    state,
    active,
    pose,
    thrust,
    half,
    ahead,
):
    """Add half a step of work, total and axial, at the velocities of ``pose``
    and those of the nodes once kicked over ``ahead`` (s)."""
    force, moment, _point = thrust
    work, v = state.work, state.payload.velocity
    rate = body_rate(state.payload, payload.inverse_inertia)
    work[THRUST] += half * (rotation.dot(force, v) + rotation.dot(moment, rate))
    work[THRUST_AXIAL] += half * force[0] * v[0]
    normal = rotation.rotate(pose.frame, _slot(state.load, NORMAL_FORCE))[0]
    drag = rotation.rotate(pose.frame, _slot(state.load, FRICTION_FORCE))[0]
    work[CONTACT_AXIAL] += half * normal * v[0]
    work[FRICTION_AXIAL] -= half * drag * v[0]
    pull = pull_on_nodes(gravity, pose)
    work[FRICTION] -= half * friction_power(
        rail, surface, state, active, pose, friction, pull, ahead
    )
    _platform_work(frame, drive, state, pose.frame, thrust, normal, drag, half)
    _gravity_work(payload, frame, gravity, state, pose.frame, half)


@kernel
def pull_on_nodes(gravity, pose):
    """Gravity in frame axes (m/s2)."""
    pull = (0.0, 0.0, 0.0)
    if gravity is not None:
        pull = rotation.unrotate(pose.frame, (gravity.x, gravity.y, gravity.z))
    return pull


@kernel
def _slot(values, first):
    return (values[first], values[first + 1], values[first + 2])


@kernel
def _platform_work(frame, drive, state, base, thrust, normal, drag, half):
    if frame is not None:
        axial = axial_velocity_of_platform(state, frame, base)
        state.work[CONTACT_AXIAL] -= half * normal * axial
        state.work[FRICTION_AXIAL] += half * drag * axial
        if drive.reacts_on_platform:
            force, _, point = thrust
            lever = _from_origin(state, point)
            rate = body_rate(state.platform, frame.inverse_inertia)
            work = rotation.dot(force, state.platform.velocity) + rotation.dot(
                rotation.cross(lever, force), rate
            )
            state.work[THRUST] -= half * work
            state.work[THRUST_AXIAL] -= half * force[0] * axial


@kernel
def _from_origin(state, point):
    p = state.platform.position
    return (point[0] - p[0], point[1] - p[1], point[2] - p[2])


@kernel
def _gravity_work(payload, frame, gravity, state, base, half):
    if gravity is not None:
        v = state.payload.velocity
        g = (gravity.x, gravity.y, gravity.z)
        momentum = rotation.rotate(base, triple(state.rail_momentum))
        state.work[GRAVITY] += half * (
            payload.mass * rotation.dot(g, v) + rotation.dot(g, momentum)
        )
        state.work[GRAVITY_AXIAL] += half * payload.mass * g[0] * v[0]
        _platform_gravity_work(frame, g, state, base, half)


@kernel
def _platform_gravity_work(frame, g, state, base, half):
    if frame is not None:
        state.work[GRAVITY] += half * frame.mass * rotation.dot(g, state.platform.velocity)
        state.work[GRAVITY_AXIAL] += (
            half * frame.total_mass * g[0] * axial_velocity_of_platform(state, frame, base)
        )


@kernel
def add_external_impulse(payload, frame, drive, gravity, state, pose, thrust, reaction, dt):
    """Impulse and moment of impulse (about the scene origin) of everything outside the counted
    system.

    Thrust counts unless the free platform takes its reaction; the ground's reaction counts when the
    platform is fixed.
    """
    force, _, point = thrust
    if frame is None:
        ground, ground_moment = reaction
        _add(state.impulse, force, rotation.cross(point, force), dt)
        _add(state.impulse, ground, ground_moment, -dt)
    if frame is not None:
        if not drive.reacts_on_platform:
            _add(state.impulse, force, rotation.cross(point, force), dt)
    if gravity is not None:
        g = (gravity.x, gravity.y, gravity.z)
        _add_weight(state.impulse, g, payload.mass, triple(state.payload.position), dt)
        _add_weight(state.impulse, g, drive.moving_mass, _centre_of_rails(drive, state, pose), dt)
        _add_platform_weight(frame, state, g, dt)


@kernel
def _centre_of_rails(drive, state, pose):
    """Mass centre of the moving nodes in inertial axes (m)."""
    turned = rotation.rotate(pose.frame, triple(state.rail_moment))
    p, m = state.platform.position, drive.moving_mass
    return (p[0] + turned[0] / m, p[1] + turned[1] / m, p[2] + turned[2] / m)


@kernel
def _add_platform_weight(frame, state, g, dt):
    if frame is not None:
        _add_weight(state.impulse, g, frame.mass, triple(state.platform.position), dt)


@kernel
def _add_weight(impulse, g, mass, centre, dt):
    weight = (mass * g[0], mass * g[1], mass * g[2])
    _add(impulse, weight, rotation.cross(centre, weight), dt)


@kernel
def _add(impulse, force, moment, dt):
    for i in range(3):
        impulse[i] += dt * force[i]
        impulse[3 + i] += dt * moment[i]
