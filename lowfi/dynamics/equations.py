"""Equations of motion of payload and platform, together with the power of every force.

    r' = v,   m v' = sum F,   q' = q w / 2,   A' = sum X x F,   h' = h x w + R' (A' - r x sum F)

X is the point at which a force acts; of bodies that are apart (``lowfi.state``), A' = sum (X - r) x F.
h and w are in body axes. There the products of h and w of a thin body cancel to rounding, even in stages of
a step, where q is no unit quaternion.

Every effect adds itself in one line of ``derivative``. Until ``move``, the velocity slots of the
derivative hold forces (N). Axial power is each force's X component times the X velocity of the
mass centre of the body it acts on (``mechanics.ledger``).
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi import system as effects
from tipoff.lowfi.contact import stick_slip
from tipoff.lowfi.contact.compliant.loads import axial_force, wall_force
from tipoff.lowfi.contact.compliant.loads import load as compliant_load
from tipoff.lowfi.contact.compliant.modes import vibrate
from tipoff.lowfi.contact.compliant.solution import solve
from tipoff.lowfi.contact.compliant.thermal_offset import is_warm
from tipoff.lowfi.contact.springs import load, penetration, relative_pose
from tipoff.lowfi.hold_down import hold
from tipoff.lowfi.pusher_inertia import resist
from tipoff.lowfi.pushers import place_of, push_of, slip_at
from tipoff.lowfi.state import IMPULSE, PAYLOAD, PLACE, PLATFORM, QUATERNION, SPIN, TURN, VELOCITY
from tipoff.lowfi.system import Body
from tipoff.mechanics.absent import pulls, rubs
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.pushers import direction_of
from tipoff.mechanics.laws.thrust import magnitude


class Bodies(NamedTuple):
    """Data of a system that the forces on both bodies need at one instant."""

    payload: slot.Motion
    base: slot.Motion  # of the platform, or of scene axes at rest
    platform: Body | None  # None for fixed rails
    friction: Friction
    evaluated: np.ndarray  # evaluations of the law of each effect (``lowfi.system``)


@kernel
def derivative(system, touching, stick, apart, time, state, out):
    """Fill ``out`` with the time derivative of ``state`` (both STATE_SIZE,). ``touching`` (f,) are
    the faces with load, ``stick`` (f, ROW_SIZE) their stick-slip states; ``apart``: A is about
    the mass centres."""
    payload, platform = system.payload, system.platform
    bodies = Bodies(
        payload=slot.motion(payload, state, PAYLOAD),
        base=slot.frame(platform, state),
        platform=platform,
        friction=system.friction,
        evaluated=system.evaluated,
    )
    out[:] = 0.0
    add_thrust(system.thrust, system.thrust_offset, system.reacts_on_platform, time, bodies, out)
    add_pushers(system.pushing, bodies, out)
    add_body_force(system.body_force, payload.mass, bodies, out)
    add_springs(system.contact, system.faces, touching, stick, bodies, out)
    add_compliant_contact(system.compliance, system.faces, touching, bodies, state, out)
    add_pusher_inertia(system.pushing, payload, bodies, state, out)
    add_hold_down(system.hold_down, payload, time, bodies, state, out)
    move(payload.mass, apart, state, PAYLOAD, bodies.payload, out)
    move_platform(platform, apart, state, bodies, out)


@kernel
def move(mass, apart, state, first, body, out):
    """Convert the force in the velocity slots of the body whose slots begin at ``first`` to an
    acceleration, and add the kinematics and the change of spin; of bodies ``apart``, refer moments to
    their mass centres."""
    w = body.body_rate
    turning = rotation.product(
        slot.quaternion(state, first), (0.0, 0.5 * w[0], 0.5 * w[1], 0.5 * w[2])
    )
    carried = rotation.cross(body.place, slot.triple(out, first + VELOCITY))
    moment = slot.triple(out, slot.moment_of(first))
    gyroscopic = rotation.cross(slot.triple(state, first + SPIN), w)
    about_centre = rotation.unrotate(
        body.turn, (moment[0] - carried[0], moment[1] - carried[1], moment[2] - carried[2])
    )
    for i in range(3):
        out[first + PLACE + i] = body.velocity[i]
        out[first + VELOCITY + i] /= mass
        out[first + SPIN + i] = gyroscopic[i] + about_centre[i]
    for i in range(4):
        out[first + QUATERNION + i] = turning[i]
    if apart:
        slot.carry(out, first, carried)


@kernel
def move_platform(platform, apart, state, bodies, out):
    """``move`` of the platform, if it is free."""
    if platform.free:
        bodies.evaluated[effects.PLATFORM] += 1
        move(platform.mass, apart, state, PLATFORM, bodies.base, out)


@kernel
def push(out, body, force, point, sign):
    """Add ``sign`` times a force at a point to the body whose slots begin at ``body``."""
    _push(out, body + VELOCITY, slot.moment_of(body), force, point, sign)


@kernel
def _push(out, force_slot, moment_slot, force, point, sign):
    moment = rotation.cross(point, force)
    for i in range(3):
        out[force_slot + i] += sign * force[i]
        out[moment_slot + i] += sign * moment[i]


@kernel
def add_thrust(thrust, offset, reacts, time, bodies, out):
    """Add the thrust and its reaction: on the platform if it ``reacts``, else outside."""
    size = magnitude(thrust.pulses, thrust.curve, time)
    if size == 0.0:
        return
    body = bodies.payload
    bodies.evaluated[effects.THRUST_OFFSET] += offset.acts
    force, point = line_of_action(offset, size, body)
    push(out, PAYLOAD, force, point, 1.0)
    velocity = slot.velocity_at(body, point)
    add_power(slot.THRUST, slot.THRUST_AXIAL, force, velocity, body.velocity[0], 1.0, out)
    react(bodies.platform, reacts, bodies, force, point, out)


@kernel
def add_power(entry, axial_entry, force, velocity, axial_speed, sign, out):
    """Add ``sign`` times the power (W) of a force (N) on a point that moves at ``velocity`` (m/s),
    and its axial part, to two slots of ``out``."""
    out[entry] += sign * rotation.dot(force, velocity)
    out[axial_entry] += sign * force[0] * axial_speed


@kernel
def add_outside_impulse(force, point, out):
    """Add a force (N) from outside, and its moment, to the rates of the impulses in ``out``."""
    _push(out, IMPULSE, TURN, force, point, 1.0)


@kernel
def line_of_action(offset, size, body):
    """Thrust (N) and a point of its line (m) in scene axes; without an offset the line passes
    through the mass centre."""
    if offset.acts:
        return _offset_line(offset, size, body)
    return (size * body.turn[0], size * body.turn[3], size * body.turn[6]), body.place


@kernel
def _offset_line(offset, size, body):
    d, arm = offset.direction, rotation.rotate(body.turn, offset.arm)
    point = (body.place[0] + arm[0], body.place[1] + arm[1], body.place[2] + arm[2])
    return rotation.rotate(body.turn, (size * d[0], size * d[1], size * d[2])), point


@kernel
def react(platform, reacts, bodies, force, point, out):
    """Add the reaction of the thrust: on a free platform that ``reacts``, or outside (exhaust, fixed
    platform)."""
    if platform.free and reacts:
        base = bodies.base
        push(out, PLATFORM, force, point, -1.0)
        velocity, speed = slot.velocity_at(base, point), base.velocity[0]
        add_power(slot.THRUST, slot.THRUST_AXIAL, force, velocity, speed, -1.0, out)
    else:
        add_outside_impulse(force, point, out)


@kernel
def add_pushers(pushing, bodies, out):
    """Add the forces of spring pushers, each a pair at one point."""
    for i in range(pushing.segment.size):
        bodies.evaluated[effects.PUSHERS] += 1
        push = push_of(pushing, i, bodies.platform, bodies.payload, bodies.base)
        speed = _axial_speed(bodies.platform, bodies)
        _pair(bodies.platform, push.force, push.point, out)
        _pair(bodies.platform, push.drag, push.point, out)
        for force, entry, axial, sign in (
            (push.force, slot.THRUST, slot.THRUST_AXIAL, 1.0),
            (push.drag, slot.FRICTION, slot.FRICTION_AXIAL, -1.0),
        ):
            add_power(entry, axial, force, push.slip, speed, sign, out)


@kernel
def add_pusher_inertia(pushing, payload, bodies, state, out):
    """Add the pairs of forces that accelerate pushers with mass, after all other forces."""
    inertia = pushing.inertia
    if inertia.pairs.size > 0:
        resist(inertia, pushing.law.mass, pushing, payload, bodies, state, out)
        for i in range(inertia.pairs.size):
            point, size = place_of(pushing, i, bodies.payload), inertia.pairs[i]
            d = rotation.rotate(bodies.base.turn, direction_of(pushing.law, i))
            _drive((-size * d[0], -size * d[1], -size * d[2]), point, bodies, out)


@kernel
def add_hold_down(latch, payload, time, bodies, state, out):
    """Add the force of the hold-down before its release, after all other forces."""
    if time < latch.release:
        bodies.evaluated[effects.HOLD_DOWN] += 1
        force, point = hold(latch, payload, bodies, state, out)
        _drive(force, point, bodies, out)


@kernel
def _drive(force, point, bodies, out):
    """Add a pair of forces (N) at a point, whose work counts as that of the thrust."""
    slip = slip_at(bodies.payload, bodies.base, point)
    speed = _axial_speed(bodies.platform, bodies)
    _pair(bodies.platform, force, point, out)
    add_power(slot.THRUST, slot.THRUST_AXIAL, force, slip, speed, 1.0, out)


@kernel
def add_body_force(force, mass, bodies, out):
    """Add the body force on the payload of ``mass`` (kg), and on the platform."""
    if pulls(force):
        bodies.evaluated[effects.BODY_FORCE] += 1
        _add_body_force(force, mass, PAYLOAD, bodies.payload, out)
        _add_body_force_on_platform(force, bodies.platform, bodies, out)


@kernel
def _add_body_force_on_platform(force, platform, bodies, out):
    if platform.free:
        _add_body_force(force, platform.mass, PLATFORM, bodies.base, out)


@kernel
def _add_body_force(force, mass, first, body, out):
    weight = (mass * force.x, mass * force.y, mass * force.z)
    push(out, first, weight, body.place, 1.0)
    add_outside_impulse(weight, body.place, out)
    velocity, speed = body.velocity, body.velocity[0]
    add_power(slot.BODY_FORCE, slot.BODY_FORCE_AXIAL, weight, velocity, speed, 1.0, out)


@kernel
def add_springs(contact, faces, touching, stick, bodies, out):
    """Add the contact springs of all ``touching`` faces."""
    if contact is not None:
        body, base, platform = bodies.payload, bodies.base, bodies.platform
        place, turn = relative_pose(platform, body, base)
        for i in range(touching.size):
            if touching[i]:
                p = penetration(contact.thermal_offset, faces[i], place, turn)
                if p > 0.0:
                    pad = load(contact, bodies.friction, platform, faces[i], p, body, base)
                    bodies.evaluated[effects.CONTACT] += 1
                    _count_thermal(contact.thermal_offset, bodies)
                    _add_pad(pad, bodies, out)
                    _add_traction(contact.sticking, stick[i], faces[i], pad, bodies, out)


@kernel
def _count_thermal(offset, bodies):
    if offset is not None:
        bodies.evaluated[effects.THERMAL] += 1


@kernel
def add_compliant_contact(compliance, faces, touching, bodies, state, out):
    """Add compliant contact under all ``touching`` faces, and the modes of the rails."""
    if compliance is not None:
        body, base, platform = bodies.payload, bodies.base, bodies.platform
        order, force = compliance.workspace.order, compliance.workspace.force
        place, turn = relative_pose(platform, body, base)
        for rail in range(compliance.members.shape[0]):
            count = solve(compliance, faces, rail, touching, place, turn, state)
            for k in range(count):
                face = order[k]
                if force[face, 0] > 0.0:
                    pad = compliant_load(
                        compliance, bodies.friction, platform, faces, face, body, base
                    )
                    _add_pad(pad, bodies, out)
                    aside, point = wall_force(compliance, faces, face, body, base)
                    _add_wall_force(aside, point, bodies, out)
            if count > 0:
                bodies.evaluated[effects.COMPLIANCE] += 1
                bodies.evaluated[effects.THERMAL] += is_warm(compliance.thermal_offset)
                bodies.evaluated[effects.MODES] += compliance.modes.square.size > 0
                along = rotation.rotate(base.turn, (axial_force(compliance, count), 0.0, 0.0))
                _add_wall_force(along, body.place, bodies, out)
            _add_modes(compliance.modes, compliance.workspace, (rail, count), state, out)


@kernel
def _add_modes(modes, workspace, pressed, state, out):
    """Add the vibration of a rail and the work of its damping; ``pressed``: its number and the
    number of faces that press it. A rail without pressing faces vibrates freely; a step knows its
    motion in advance (``lowfi.contact.compliant.free_vibration``)."""
    rail, count = pressed
    if modes.square.size > 0 and count > 0:
        out[slot.STRUCTURAL] += vibrate(modes, workspace, rail, count, state, out)


@kernel
def _add_wall_force(force, point, bodies, out):
    """Add a force of a wall along or across the rail; its work is the energy of the rail."""
    _pair(bodies.platform, force, point, out)
    out[slot.CONTACT_AXIAL] += force[0] * _axial_speed(bodies.platform, bodies)


@kernel
def _add_pad(pad, bodies, out):
    """Add the load of one touching face, a pair of forces at one point, and the conversion of its
    energy."""
    _pair(bodies.platform, pad.normal, pad.point, out)
    axial_speed = _axial_speed(bodies.platform, bodies)
    _add_contact_power(pad, axial_speed, out)
    _add_friction(bodies.friction, pad, bodies, axial_speed, out)


@kernel
def _add_contact_power(pad, axial_speed, out):
    if pad.raw >= 0.0:
        out[slot.DAMPING] += (pad.raw - pad.elastic) * pad.closing
    else:
        out[slot.RELEASED] -= pad.elastic * pad.closing
    out[slot.CONTACT_AXIAL] += pad.normal[0] * axial_speed


@kernel
def _add_friction(friction, pad, bodies, axial_speed, out):
    if rubs(friction):
        bodies.evaluated[effects.FRICTION] += 1
        _pair(bodies.platform, pad.drag, pad.point, out)
        add_power(
            slot.FRICTION,
            slot.FRICTION_AXIAL,
            pad.drag,
            pad.slip,
            axial_speed,
            -1.0,
            out,
        )


@kernel
def _add_traction(sticking, row, face, pad, bodies, out):
    """Add friction with sticking. Only the heat of its work is lost; the spring stores the rest.
    The axial part of the whole work counts as friction, because the energy of the spring ends there
    too."""
    if stick_slip.acts(sticking):
        bodies.evaluated[effects.STICKING] += 1
        drag, heat = stick_slip.traction(sticking, row, face, pad, bodies.base)
        _pair(bodies.platform, drag, pad.point, out)
        out[slot.FRICTION] += heat
        out[slot.FRICTION_AXIAL] -= drag[0] * _axial_speed(bodies.platform, bodies)


@kernel
def _pair(platform, force, point, out):
    """Add a force on the payload, and its opposite at the same point on the platform or the
    ground."""
    push(out, PAYLOAD, force, point, 1.0)
    if platform.free:
        push(out, PLATFORM, force, point, -1.0)
    else:
        add_outside_impulse(force, point, out)


@kernel
def _axial_speed(platform, bodies):
    """X velocity (m/s) of the payload's mass centre relative to the platform's."""
    if platform.free:
        return bodies.payload.velocity[0] - bodies.base.velocity[0]
    return bodies.payload.velocity[0]
