"""Loads other than contact: thrust and body force, and the work of all loads.

Work is counted in halves around each kick, ``dt/2 f(n) v(n-1/2)`` before and ``dt/2 f(n) v(n+1/2)``
after. With the kinetic energy ``v(n-1/2) M v(n+1/2) / 2`` the balance of central differences is
then an identity for every force. So the ledgers show only forces that are not conservative or not
smooth.
"""

from tipoff.highfi.contact.pads import friction_power
from tipoff.highfi.dynamics.hold_down import work_of_hold_down
from tipoff.highfi.dynamics.pushers import work_of_pushers
from tipoff.highfi.state.pose import body_matrix, body_rate, origin_of_frame, triple
from tipoff.highfi.state.records import AXIAL, BODY_FORCE, THRUST_OFFSET, TOTAL
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics.absent import pulls
from tipoff.mechanics.laws.thrust import magnitude


@kernel
def line_of_action(arm, offset):
    """Thrust direction and arm in body axes; axial through the mass centre without an ``offset``."""
    line = ((1.0, 0.0, 0.0), (-arm, 0.0, 0.0))
    if offset.acts:
        line = offset.direction, offset.arm
    return line


@inlined
def thrust_load(constants, state, time):
    """Thrust force (N), moment about the payload's mass centre (N m) and point of application (m),
    in inertial axes."""
    direction, arm = line_of_action(constants.drive.arm, constants.thrust_offset)
    state.evaluated[THRUST_OFFSET] += constants.thrust_offset.acts
    turn = body_matrix(state.payload)
    push = magnitude(constants.thrust.pulses, constants.thrust.curve, time)
    force = rotation.rotate(turn, (push * direction[0], push * direction[1], push * direction[2]))
    lever = rotation.rotate(turn, arm)
    p = state.payload.position
    return force, rotation.cross(lever, force), (p[0] + lever[0], p[1] + lever[1], p[2] + lever[2])


@kernel
def body_force_in_frame(body_force, state, pose):
    """Acceleration (m/s2) by the body force in frame axes; zero without one."""
    acceleration = (0.0, 0.0, 0.0)
    if pulls(body_force):
        state.evaluated[BODY_FORCE] += 1
        acceleration = rotation.unrotate(pose.frame, triple(body_force))
    return acceleration


@kernel
def accelerate(body_force, body, dt):
    """Advance the velocity of a rigid body over ``dt`` by the body force."""
    if pulls(body_force):
        for i in range(3):
            body.velocity[i] += dt * body_force[i]


@kernel
def axial_velocity_of_platform(state, frame, base):
    """Inertial X velocity (m/s) of the mass centre of platform and rails."""
    momentum = rotation.rotate(base, triple(state.rail_momentum))
    return (frame.mass * state.platform.velocity[0] + momentum[0]) / frame.total_mass


@inlined
def add_work(constants, state, active, pose, thrust, ahead):
    """Add half a step of work, total and axial, at the velocities of ``pose`` and at those of the
    nodes after a kick of ``ahead`` (s)."""
    half, load, v = 0.5 * constants.dt, state.load[0], state.payload.velocity
    total, axial = state.work[TOTAL], state.work[AXIAL]
    force, moment, _point = thrust
    rate = body_rate(state.payload, constants.payload.inverse_inertia)
    total.thrust += half * (rotation.dot(force, v) + rotation.dot(moment, rate))
    axial.thrust += half * force[0] * v[0]
    normal = rotation.rotate(pose.frame, triple(load.normal_force))[0]
    drag = rotation.rotate(pose.frame, triple(load.friction_force))[0]
    axial.contact_axial += half * normal * v[0]
    axial.friction -= half * drag * v[0]
    acceleration = body_force_in_frame(constants.body_force, state, pose)
    total.friction -= half * friction_power(
        constants.friction, constants, state, active, pose, acceleration, ahead
    )
    if state.pushing.segment.size > 0:
        speed = _axial_speed(constants.frame, state, pose.frame)
        work_of_pushers(constants.pushers, constants.frame, state, pose, speed, half)
    if state.holding[0] != 0.0:
        speed = _axial_speed(constants.frame, state, pose.frame)
        work_of_hold_down(constants.hold_down, constants, state, pose, speed, half)
    _platform_work(constants.frame, constants, state, pose.frame, thrust, (normal, drag))
    if pulls(constants.body_force):
        _body_force_work(constants.body_force, constants, state, pose.frame)


@kernel
def _axial_speed(frame, state, base):
    """X velocity (m/s) of the payload's mass centre relative to that of platform and rails."""
    speed = state.payload.velocity[0]
    if frame.free:
        speed -= axial_velocity_of_platform(state, frame, base)
    return speed


@inlined
def _platform_work(frame, constants, state, base, thrust, contact):
    """``contact`` (N): normal force and friction on the payload along X."""
    if frame.free:
        half, total, axial = 0.5 * constants.dt, state.work[TOTAL], state.work[AXIAL]
        velocity = axial_velocity_of_platform(state, frame, base)
        axial.contact_axial -= half * contact[0] * velocity
        axial.friction += half * contact[1] * velocity
        if constants.drive.reacts_on_platform:
            force, _, point = thrust
            lever = _from_origin(state, point)
            rate = body_rate(state.platform, frame.inverse_inertia)
            work = rotation.dot(force, state.platform.velocity) + rotation.dot(
                rotation.cross(lever, force), rate
            )
            total.thrust -= half * work
            axial.thrust -= half * force[0] * velocity


@kernel
def _from_origin(state, point):
    p = state.platform.position
    return (point[0] - p[0], point[1] - p[1], point[2] - p[2])


@inlined
def _body_force_work(body_force, constants, state, base):
    half, mass, v = 0.5 * constants.dt, constants.payload.mass, state.payload.velocity
    g = triple(body_force)
    momentum = rotation.rotate(base, triple(state.rail_momentum))
    state.work[TOTAL].body_force += half * (mass * rotation.dot(g, v) + rotation.dot(g, momentum))
    state.work[AXIAL].body_force += half * mass * g[0] * v[0]
    _body_force_work_on_platform(constants.frame, half, g, state, base)


@inlined
def _body_force_work_on_platform(frame, half, g, state, base):
    if frame.free:
        state.work[TOTAL].body_force += half * frame.mass * rotation.dot(g, state.platform.velocity)
        state.work[AXIAL].body_force += (
            half * frame.total_mass * g[0] * axial_velocity_of_platform(state, frame, base)
        )


@inlined
def add_external_impulse(frame, constants, state, pose, thrust, reaction, dt):
    """Impulse and moment of impulse (about the scene origin) of everything outside the counted
    system.

    Thrust counts unless the free platform takes its reaction. The ``reaction`` of the ground, force
    and moment, counts if the platform is fixed.
    """
    force, _, point = thrust
    if not (frame.free and constants.drive.reacts_on_platform):
        _add(state.impulse, force, rotation.cross(point, force), dt)
    if not frame.free:
        ground, ground_moment = reaction
        _add(state.impulse, ground, ground_moment, -dt)
    if pulls(constants.body_force):
        _add_body_force(triple(constants.body_force), constants, state, pose, dt)


@inlined
def _add_body_force(g, constants, state, pose, dt):
    payload, drive = triple(state.payload.position), constants.drive
    _add_weight(state.impulse, g, constants.payload.mass, payload, dt)
    if drive.moving_mass > 0.0:
        place = _centre_of_rails(constants.frame, drive, state, pose)
        _add_weight(state.impulse, g, drive.moving_mass, place, dt)
    _add_platform_weight(constants.frame, state, g, dt)


@kernel
def _centre_of_rails(frame, drive, state, pose):
    """Mass centre of the stepped nodes, in inertial axes (m)."""
    turned = rotation.rotate(pose.frame, triple(state.rail_moment))
    p, m = origin_of_frame(frame, state.platform, pose.frame), drive.moving_mass
    return (p[0] + turned[0] / m, p[1] + turned[1] / m, p[2] + turned[2] / m)


@kernel
def _add_platform_weight(frame, state, g, dt):
    if frame.free:
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
