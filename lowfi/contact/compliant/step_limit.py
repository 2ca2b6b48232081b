"""The proven step limit on walls that give way: stiffness and damping of the faces of each rail
(``lowfi.contact.step_limit`` has the bound).

With the tangent T = K (1 + F K)^-1 of ``lowfi.contact.compliant.solution`` and the wrenches g of depth, tilt
along and tilt across of each rigid face, the linearised springs are sum_ab T_ab g_a g_b', and the
trace over both bodies bounds what they can do. A way across the rail along a wall of slope du/deta'
= U_2 + xi' U_4 + 2 eta' U_5 is a depth and tilts too, so each g has its part of a force there::

    K = sum over rails of sum_ab T_ab (g_a . M^-1 g_b)

Modes of rails that move or are pressed add a diagonal of omega^2 and d to the matrices, which
raises their spectra by the largest of each (Weyl), and the trace of what contact does to them, W' T
W.
"""

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant.loads import load
from tipoff.lowfi.contact.compliant.modes import fastest
from tipoff.lowfi.contact.compliant.record import ASIDE, SHIFT
from tipoff.lowfi.contact.compliant.solution import eliminate, fill_matrix, solve, stiffness
from tipoff.lowfi.contact.springs import along_width, outward, pad_point, relative_pose
from tipoff.lowfi.contact.step_limit import friction_damping
from tipoff.mechanics.rail_compliance import PATTERNS

_RIGID = 3  # depth, tilt along, tilt across


@kernel
def stiffness_and_damping(compliance, friction, faces, platform, payload, active, state):
    """Traces K (1/s2) and C (1/s) of all faces that are ``active`` (f,) at ``state``."""
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    springs, dampers, square, drag = 0.0, 0.0, 0.0, 0.0
    for rail in range(compliance.members.shape[0]):
        count = solve(compliance, faces, rail, active, place, turn, state)
        by_rail = fastest(compliance.modes, rail, count > 0, state)
        square, drag = max(square, by_rail[0]), max(drag, by_rail[1])
        for i in range(count):
            face = compliance.room.order[i]
            if compliance.room.force[face, 0] > 0.0:
                now = load(compliance, friction, platform, faces, face, body, base)
                dampers += friction_damping(
                    friction, now, platform, payload, body, base, outward(faces[face], base)
                )
        if count > 0:
            columns = _tangent(compliance, count)
            springs += _trace(
                compliance, faces, platform, payload, count, body, base
            ) + _trace_of_modes(compliance.modes, compliance.room, count, columns)
    return springs + square, dampers + drag


@kernel
def _tangent(compliance, count):
    """Fill ``right`` with dU (w,) by a unit of each rigid motion, then of each mode; how many
    columns the former take."""
    room = compliance.room
    fill_matrix(room, count)
    wide = count * PATTERNS
    for row in range(wide):
        for j in range(count):
            face = room.order[j]
            for rigid in range(_RIGID):
                total = 0.0
                for c in range(PATTERNS):
                    column = j * PATTERNS + c
                    total += room.flexibility[row, column] * _reaction(room, face, c, rigid)
                room.right[row, j * _RIGID + rigid] = total
    # dU = (1 + F K)^-1 F K e, dP = K (e - dU)
    eliminate(
        room.matrix, room.right, wide, count * _RIGID + _add_modes(compliance.modes, room, count)
    )
    return count * _RIGID


@inlined
def _add_modes(modes, room, count):
    """Fill the columns of the modes, whose number this is, before elimination."""
    number = 0
    if modes is not None:
        number = modes.square.shape[1]
        for row in range(count * PATTERNS):
            for i in range(number):
                total = 0.0
                for j in range(count):
                    face = room.order[j]
                    for c in range(PATTERNS):
                        total += room.flexibility[row, j * PATTERNS + c] * _pressure(
                            modes, room, face, c, i
                        )
                room.right[row, count * _RIGID + i] = total
    return number


@inlined
def _pressure(modes, room, face, a, i):
    """dP_a by a unit of mode i on a wall that is stiff else."""
    value = 0.0
    for b in range(PATTERNS):
        value += stiffness(room.moment[face], a, b) * modes.shape[face, i, b]
    return value


@inlined
def _trace_of_modes(modes, room, count, first):
    """Trace (1/s2) of W' T W; dU of the modes stands in ``right`` from the column ``first`` on."""
    total = 0.0
    if modes is not None:
        for k in range(count):
            face = room.order[k]
            for a in range(PATTERNS):
                for i in range(modes.square.shape[1]):
                    total += _pressure(modes, room, face, a, i) * (
                        modes.shape[face, i, a] - room.right[k * PATTERNS + a, first + i]
                    )
    return total


@inlined
def _reaction(room, face, a, rigid):
    """dP_a by a unit of a rigid motion on a wall at rest."""
    value = stiffness(room.moment[face], a, rigid)
    if rigid > 0:
        value -= _beyond(room, face, rigid) * stiffness(room.moment[face], a, 0)
    return value


@inlined
def _beyond(room, face, rigid):
    """How far the place on the wall is beyond that on the pad, along xi or eta."""
    return room.lever[face, SHIFT if rigid == 1 else ASIDE]


@kernel
def _answer(room, i, rigid, column):
    """Generalised force of rigid motion ``rigid`` on face i of the order, by a unit of motion
    number ``column``."""
    face = room.order[i]
    total = _own(room, face, rigid, column % _RIGID) if column // _RIGID == i else 0.0
    for c in range(PATTERNS):
        total -= _reaction(room, face, c, rigid) * room.right[i * PATTERNS + c, column]
    return total


@inlined
def _own(room, face, rigid, other):
    value = _reaction(room, face, rigid, other)
    if rigid > 0:
        value -= _beyond(room, face, rigid) * _reaction(room, face, 0, other)
    return value


@kernel
def _trace(compliance, faces, platform, payload, count, body, base):
    total = 0.0
    for i in range(count):
        for a in range(_RIGID):
            first = _wrench(compliance, faces, compliance.room.order[i], a, body, base)
            for j in range(count):
                for b in range(_RIGID):
                    second = _wrench(compliance, faces, compliance.room.order[j], b, body, base)
                    total += _answer(compliance.room, i, a, j * _RIGID + b) * _met(
                        platform, payload, body, base, first, second
                    )
    return abs(total)


@inlined
def _wrench(compliance, faces, face, rigid, body, base):
    """Force, a point it acts at (m), and couple that belong to a rigid motion of the face."""
    n, half = outward(faces[face], base), compliance.half[face]
    aside = rotation.rotate(
        base.turn, along_width(faces[face], -_by_slope(compliance.room, face, rigid) / half[1])
    )
    if rigid == 0:
        return (
            (n[0] + aside[0], n[1] + aside[1], n[2] + aside[2]),
            pad_point(faces[face], body),
            (0.0, 0.0, 0.0),
        )
    edge = along_width(faces[face], half[1]) if rigid == 2 else (half[0], 0.0, 0.0)
    return aside, pad_point(faces[face], body), rotation.cross(rotation.rotate(body.turn, edge), n)


@inlined
def _by_slope(room, face, rigid):
    """What the slope of the wall across has of a rigid motion, as a sum over 1, xi and eta of the
    pad."""
    u, lever = room.displacement[face], room.lever[face]
    if rigid == 0:
        return u[2] + lever[SHIFT] * u[4] + 2.0 * lever[ASIDE] * u[5]
    return u[4] if rigid == 1 else 2.0 * u[5]


@kernel
def _met(platform, payload, body, base, first, second):
    """g_a . M^-1 g_b of two wrenches on both bodies."""
    total = _of_body(payload.mass, payload.inverse_inertia, body, first, second)
    if platform is not None:
        total += _of_body(platform.mass, platform.inverse_inertia, base, first, second)
    return total


@inlined
def _of_body(mass, inverse_inertia, body, first, second):
    a, b = _moment(body, first), _moment(body, second)
    return rotation.dot(first[0], second[0]) / mass + rotation.dot(
        a, rotation.angular_velocity(body.turn, inverse_inertia, b)
    )


@inlined
def _moment(body, wrench):
    p, q = wrench[1], body.place
    swing = rotation.cross((p[0] - q[0], p[1] - q[1], p[2] - q[2]), wrench[0])
    return (swing[0] + wrench[2][0], swing[1] + wrench[2][1], swing[2] + wrench[2][2])
