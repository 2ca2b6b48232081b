"""Equations of motion of payload and platform, with the power of every force beside them.

    r' = v,   m v' = sum F,   q' = w q / 2,   A' = sum X x F   (X the point a force acts at, all about the scene origin)

Every effect adds itself to the derivative in one line of ``derivative``; while it is filled, the
velocity slots hold forces (N). Axial power is each force's X component times the X velocity of the
mass centre of the body it acts on (``mechanics.ledger``).
"""

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip as grips
from tipoff.lowfi.contact.compliant.loads import drive, lean
from tipoff.lowfi.contact.compliant.loads import load as wall_load
from tipoff.lowfi.contact.compliant.modes import swing
from tipoff.lowfi.contact.compliant.solution import solve
from tipoff.lowfi.contact.springs import load, penetration, relative_pose, relative_velocity
from tipoff.lowfi.state import IMPULSE, MOMENT, PAYLOAD, PLACE, PLATFORM, QUATERNION, TURN, VELOCITY
from tipoff.scenes.effects.thrust_law import magnitude


@inlined
def derivative(system, active, grip, time, state, out):
    """Fill ``out`` with the time derivative of ``state`` (both STATE_SIZE,). ``active`` (f,) tells
    which faces are felt, ``grip`` (f, GRIP_SIZE) or None how they stick."""
    body = slot.motion(system.payload.mass, system.payload.inverse_inertia, state, PAYLOAD)
    base = slot.frame(system.platform, state)
    out[:] = 0.0
    add_thrust(
        system.thrust,
        system.thrust_offset,
        system.platform,
        system.reacts_on_platform,
        system.ledger,
        time,
        body,
        base,
        out,
    )
    add_gravity(system.gravity, system.payload, system.platform, system.ledger, body, base, out)
    add_contact(
        system.contact,
        system.friction,
        system.sticking,
        system.faces,
        system.platform,
        system.ledger,
        active,
        grip,
        body,
        base,
        out,
    )
    add_walls(
        system.compliance,
        system.friction,
        system.faces,
        system.platform,
        system.ledger,
        active,
        body,
        base,
        state,
        out,
    )
    move(system.payload.mass, state[:PLATFORM], body, out[:PLATFORM])
    move_platform(system.platform, state, base, out)


@inlined
def move(mass, state, body, out):
    """Turn the force in the velocity slots into acceleration and add the kinematics."""
    turning = rotation.product(
        (0.0, 0.5 * body.rate[0], 0.5 * body.rate[1], 0.5 * body.rate[2]), slot.quaternion(state, 0)
    )
    for i in range(3):
        out[PLACE + i] = body.velocity[i]
        out[VELOCITY + i] /= mass
    for i in range(4):
        out[QUATERNION + i] = turning[i]


@inlined
def move_platform(platform, state, base, out):
    if platform is not None:
        move(platform.mass, state[PLATFORM:], base, out[PLATFORM:])


@inlined
def push(out, force_slot, moment_slot, force, point, sign):
    """Add ``sign`` times a force at a point to a body, or to the impulse from outside."""
    moment = rotation.cross(point, force)
    for i in range(3):
        out[force_slot + i] += sign * force[i]
        out[moment_slot + i] += sign * moment[i]


@inlined
def add_thrust(thrust, offset, platform, reacts, ledger, time, body, base, out):
    size = magnitude(thrust.pulses, thrust.curve, time)
    if size == 0.0:
        return
    force, point = line_of_action(offset, size, body)
    push(out, PAYLOAD + VELOCITY, PAYLOAD + MOMENT, force, point, 1.0)
    _book(
        ledger,
        slot.THRUST,
        slot.THRUST_AXIAL,
        force,
        slot.velocity_at(body, point),
        body.velocity[0],
        1.0,
        out,
    )
    react(platform, reacts, ledger, force, point, base, out)


@inlined
def _book(ledger, entry, axial_entry, force, velocity, axial_speed, sign, out):
    """Add the power of a force on a point, and its axial part, to the ledger."""
    if ledger is not None:
        out[entry] += sign * rotation.dot(force, velocity)
        out[axial_entry] += sign * force[0] * axial_speed


@inlined
def _outside(ledger, force, point, out):
    """Count a force from outside among the impulses."""
    if ledger is not None:
        push(out, IMPULSE, TURN, force, point, 1.0)


@inlined
def line_of_action(offset, size, body):
    """Thrust (N) and a point of its line (m) in scene axes; without an offset the line passes
    through the mass centre."""
    if offset is not None:
        return _offset_line(offset, size, body)
    return (size * body.turn[0], size * body.turn[3], size * body.turn[6]), body.place


@inlined
def _offset_line(offset, size, body):
    d, arm = offset.direction, rotation.rotate(body.turn, offset.arm)
    point = (body.place[0] + arm[0], body.place[1] + arm[1], body.place[2] + arm[2])
    return rotation.rotate(body.turn, (size * d[0], size * d[1], size * d[2])), point


@inlined
def react(platform, reacts, ledger, force, point, base, out):
    """Reaction of the thrust: on a free platform, or outside (exhaust, fixed platform)."""
    if platform is None:
        _outside(ledger, force, point, out)
    if platform is not None:
        _react_on_free_platform(reacts, ledger, force, point, base, out)


@inlined
def _react_on_free_platform(reacts, ledger, force, point, base, out):
    if reacts:
        push(out, PLATFORM + VELOCITY, PLATFORM + MOMENT, force, point, -1.0)
        _book(
            ledger,
            slot.THRUST,
            slot.THRUST_AXIAL,
            force,
            slot.velocity_at(base, point),
            base.velocity[0],
            -1.0,
            out,
        )
    else:
        _outside(ledger, force, point, out)


@inlined
def add_gravity(gravity, payload, platform, ledger, body, base, out):
    if gravity is not None:
        _weigh(gravity, payload.mass, PAYLOAD, ledger, body, out)
        _weigh_platform(gravity, platform, ledger, base, out)


@inlined
def _weigh_platform(gravity, platform, ledger, base, out):
    if platform is not None:
        _weigh(gravity, platform.mass, PLATFORM, ledger, base, out)


@inlined
def _weigh(gravity, mass, which, ledger, body, out):
    weight = (mass * gravity.x, mass * gravity.y, mass * gravity.z)
    push(out, which + VELOCITY, which + MOMENT, weight, body.place, 1.0)
    _outside(ledger, weight, body.place, out)
    _book(
        ledger, slot.GRAVITY, slot.GRAVITY_AXIAL, weight, body.velocity, body.velocity[0], 1.0, out
    )


@inlined
def add_contact(laws, friction, sticking, faces, platform, ledger, active, grip, body, base, out):
    if laws is not None:
        place, turn = relative_pose(platform, body, base)
        for i in range(active.size):
            if active[i]:
                p = penetration(laws.bow, faces[i], place, turn)
                if p > 0.0:
                    face = load(laws, friction, platform, faces[i], p, body, base)
                    _press(face, friction, platform, ledger, body, base, out)
                    _grip(sticking, grip, i, faces, face, platform, ledger, body, base, out)


@kernel
def add_walls(compliance, friction, faces, platform, ledger, active, body, base, state, out):
    if compliance is not None:
        place, turn = relative_pose(platform, body, base)
        for rail in range(compliance.members.shape[0]):
            count = solve(compliance, faces, rail, active, place, turn, state)
            for k in range(count):
                face = compliance.room.order[k]
                if compliance.room.force[face, 0] > 0.0:
                    _press(
                        wall_load(compliance, friction, platform, faces, face, body, base),
                        friction,
                        platform,
                        ledger,
                        body,
                        base,
                        out,
                    )
                    _lean(compliance, faces, face, platform, ledger, body, base, out)
            if count > 0:
                _drive(compliance, count, platform, ledger, body, base, out)
            _swing(compliance.modes, compliance.room, rail, count, ledger, state, out)


@inlined
def _swing(modes, room, rail, count, ledger, state, out):
    """Add the motion of the modes of a rail, and what damping takes from them."""
    if modes is not None:
        loss = swing(modes, room, rail, count, state, out)
        if ledger is not None:
            out[slot.STRUCTURAL] += loss


@inlined
def _lean(compliance, faces, face, platform, ledger, body, base, out):
    """Add what a wall that slopes across the rail does there; its work is the walls' own energy."""
    force, point = lean(compliance, faces, face, body, base)
    _pair(platform, ledger, force, point, out)
    if ledger is not None:
        out[slot.CONTACT_AXIAL] += force[0] * _axial_speed(platform, body, base)


@inlined
def _drive(compliance, count, platform, ledger, body, base, out):
    """Add what the walls do along the rail, at the payload's mass centre."""
    pull, fading = drive(compliance, count)
    force = rotation.rotate(base.turn, (pull, 0.0, 0.0))
    _pair(platform, ledger, force, body.place, out)
    if ledger is not None:
        out[slot.RELEASED] += (
            fading
            * rotation.unrotate(base.turn, relative_velocity(platform, body, base, body.place))[0]
        )
        out[slot.CONTACT_AXIAL] += force[0] * _axial_speed(platform, body, base)


@inlined
def _press(face, friction, platform, ledger, body, base, out):
    """Add the load of one touching face: the pair of forces at one point, and what its energy
    becomes."""
    _pair(platform, ledger, face.normal, face.point, out)
    _spend(ledger, face, platform, body, base, out)
    _rub(friction, face, platform, ledger, body, base, out)


@inlined
def _grip(sticking, grip, number, faces, face, platform, ledger, body, base, out):
    """Add the friction that sticks. Of its work only the heat is lost, what the spring takes is
    stored; the axial part of all of it stands with friction, where the spring's energy ends too."""
    if sticking is not None:
        drag, heat = grips.traction(sticking, grip[number], faces[number], face, base)
        _pair(platform, ledger, drag, face.point, out)
        _lose(ledger, heat, drag[0] * _axial_speed(platform, body, base), out)


@inlined
def _lose(ledger, heat, axial_power, out):
    if ledger is not None:
        out[slot.FRICTION] += heat
        out[slot.FRICTION_AXIAL] -= axial_power


@inlined
def _spend(ledger, face, platform, body, base, out):
    if ledger is not None:
        if face.raw >= 0.0:
            out[slot.DAMPING] += (face.raw - face.elastic) * face.closing
        else:
            out[slot.RELEASED] -= face.elastic * face.closing
        out[slot.CONTACT_AXIAL] += face.normal[0] * _axial_speed(platform, body, base)


@inlined
def _rub(friction, face, platform, ledger, body, base, out):
    if friction is not None:
        _pair(platform, ledger, face.drag, face.point, out)
        _book(
            ledger,
            slot.FRICTION,
            slot.FRICTION_AXIAL,
            face.drag,
            face.slip,
            _axial_speed(platform, body, base),
            -1.0,
            out,
        )


@inlined
def _pair(platform, ledger, force, point, out):
    """A force on the payload and its opposite at the same point, on the platform or on the
    ground."""
    push(out, PAYLOAD + VELOCITY, PAYLOAD + MOMENT, force, point, 1.0)
    if platform is None:
        _outside(ledger, force, point, out)
    if platform is not None:
        push(out, PLATFORM + VELOCITY, PLATFORM + MOMENT, force, point, -1.0)


@inlined
def _axial_speed(platform, body, base):
    """X velocity (m/s) of the payload's mass centre, less the platform's."""
    if platform is not None:
        return body.velocity[0] - base.velocity[0]
    return body.velocity[0]
