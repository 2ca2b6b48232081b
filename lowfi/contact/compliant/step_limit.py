"""The proven step limit of compliant contact: stiffness and damping of the faces of each rail
(``lowfi.contact.step_limit`` derives the bound).

With the tangent T = K (1 + F K)^-1 of ``lowfi.contact.compliant.solution`` and the wrenches g of
depth, tilt along and tilt across of each rigid face, the linearised springs are sum_ab T_ab g_a
g_b', and the trace over both bodies is their bound. A motion across the rail along a wall of slope
du/deta' = U_2 + xi' U_4 + 2 eta' U_5 changes depth and tilts too, so each g includes a force across
the rail::

    K = sum over rails of sum_ab T_ab (g_a . M^-1 g_b)

A wall that is not straight as drawn also has slopes along the rail. g includes their part that is
linear in xi and eta. The rest, at most r in each cell (``drawn_slopes``), adds a matrix with a
trace R. R is at most k A r^2 times the inverse mass, since T <= K; so the trace is at most (sqrt(K)
+ sqrt(R))^2 (Minkowski).

Modes of loaded rails add a diagonal of omega^2 and d to the matrices. This raises their spectra by
the largest of each (Weyl), and by the trace of contact on the modes, S' T S.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import drawn_slopes, drawn_walls, patterns
from tipoff.lowfi.contact.compliant.loads import load
from tipoff.lowfi.contact.compliant.modes import fastest
from tipoff.lowfi.contact.compliant.record import ASIDE, SHIFT
from tipoff.lowfi.contact.compliant.solution import (
    eliminate,
    fill_matrix,
    solve_unless,
    take_flexibility,
    take_pressed,
)
from tipoff.lowfi.contact.springs import along_width, outward, pad_point, relative_pose
from tipoff.lowfi.contact.step_limit import friction_damping, inverse_mass

_RIGID = 3  # depth, tilt along, tilt across
# Columns of ``Workspace.answers``: force, moment and rate of the payload, then those of the platform.
_FORCE, _MOMENT, _RATE, _OF_PLATFORM = 0, 3, 6, 9


@kernel
def stiffness_and_damping(compliance, friction, faces, platform, payload, touching, state, solved):
    """Traces K (1/s2) and C (1/s) of all ``touching`` faces (f,) at ``state``; ``solved``: all
    rails are already solved there."""
    body, base = (
        slot.motion(payload, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    springs, dampers, square, drag = 0.0, 0.0, 0.0, 0.0
    for rail in range(compliance.members.shape[0]):
        count = solve_unless(solved, compliance, faces, rail, touching, place, turn, state)
        by_rail = fastest(compliance.modes, rail, count > 0)
        square, drag = max(square, by_rail[0]), max(drag, by_rail[1])
        for i in range(count):
            face = compliance.workspace.order[i]
            if compliance.workspace.force[face, 0] > 0.0:
                now = load(compliance, friction, platform, faces, face, body, base)
                dampers += friction_damping(
                    friction, now, platform, payload, body, base, outward(faces[face], base)
                )
        count = _keep_pressed(compliance.workspace, count)
        if count > 0:
            take_flexibility(compliance, count, place[0] + faces[0, 0], state)
            columns = _tangent(compliance, count)
            linear = _trace(compliance, faces, platform, payload, count, body, base)
            rest = _trace_of_rest(compliance, faces, platform, payload, count, body, base)
            springs += linear + _trace_of_modes(
                compliance.modes, compliance.workspace, count, columns
            )
            springs += rest + 2.0 * np.sqrt(linear * rest)
    return springs + square, dampers + drag


@kernel
def _keep_pressed(workspace, count):
    """Keep in ``order`` the faces with a pressed cell; returns their number. The others have no K."""
    pressed = take_pressed(workspace, count)
    for i in range(count):
        workspace.yielding[workspace.order[i]] = 0.0
    for i in range(pressed):
        workspace.order[i] = workspace.order[workspace.pressing[i]]
    return take_pressed(workspace, pressed)


@kernel
def _tangent(compliance, count):
    """Fill ``right`` with dU (w,) for a unit of each rigid motion, then of each mode, and
    ``yielding`` with dU of each face for its own motions; returns the number of columns of rigid
    motions."""
    workspace, size = compliance.workspace, patterns.count(compliance.workspace.levels)
    fill_matrix(workspace, count)
    for i in range(count):
        for j in range(count):
            face, block = workspace.order[j], workspace.flexibility[i, j]
            for rigid in range(_RIGID):
                for a in range(size):
                    total = 0.0
                    for c in range(size):
                        total += block[a * size + c] * _reaction(workspace, face, c, rigid)
                    workspace.right[i * size + a, j * _RIGID + rigid] = total
    # dU = (1 + F K)^-1 F K e, dP = K (e - dU)
    eliminate(
        workspace.matrix,
        workspace.right,
        count * size,
        count * _RIGID + _add_modes(compliance.modes, workspace, count),
    )
    for i in range(count):
        for rigid in range(_RIGID):
            for a in range(size):
                workspace.yielding[workspace.order[i], rigid, a] = workspace.right[
                    i * size + a, i * _RIGID + rigid
                ]
    return count * _RIGID


@kernel
def _add_modes(modes, workspace, count):
    """Fill the columns of the modes before elimination; returns their number."""
    number = 0
    if modes.square.size > 0:
        number, size = modes.square.shape[1], patterns.count(workspace.levels)
        _fill_pressed(modes, workspace, count)
        for row in range(count * size):
            for i in range(number):
                total, first = 0.0, row % size * size
                for j in range(count):
                    face, block = workspace.order[j], workspace.flexibility[row // size, j]
                    for c in range(size):
                        total += block[first + c] * modes.pressed[face, i, c]
                workspace.right[row, count * _RIGID + i] = total
    return number


@kernel
def _fill_pressed(modes, workspace, count):
    """Fill ``Modes.pressed`` of the first ``count`` faces in order."""
    size = patterns.count(workspace.levels)
    for k in range(count):
        face = workspace.order[k]
        for i in range(modes.square.shape[1]):
            for a in range(size):
                value = 0.0
                for b in range(size):
                    value += workspace.stiffness[face, a, b] * modes.shape[face, i, b]
                modes.pressed[face, i, a] = value


@kernel
def _trace_of_modes(modes, workspace, count, first):
    """Trace (1/s2) of S' T S; ``right`` has dU of the modes from the column ``first`` on."""
    total = 0.0
    if modes.square.size > 0:
        size = patterns.count(workspace.levels)
        for k in range(count):
            face = workspace.order[k]
            for a in range(size):
                for i in range(modes.square.shape[1]):
                    total += modes.pressed[face, i, a] * (
                        modes.shape[face, i, a] - workspace.right[k * size + a, first + i]
                    )
    return total


@kernel
def _reaction(workspace, face, a, rigid):
    """dP_a for a unit of a rigid motion on a wall at rest."""
    value = workspace.stiffness[face, a, rigid]
    if rigid > 0:
        value -= _beyond(workspace, face, rigid) * workspace.stiffness[face, a, 0]
    return value


@kernel
def _beyond(workspace, face, rigid):
    """Distance of the place on the wall beyond that on the pad, along xi or eta."""
    return workspace.lever[face, SHIFT if rigid == 1 else ASIDE]


@kernel
def _answer(workspace, i, rigid, column):
    """Generalised force of rigid motion ``rigid`` on face i of the order, for a unit of motion
    number ``column``."""
    face, size = workspace.order[i], patterns.count(workspace.levels)
    total = _own(workspace, face, rigid, column % _RIGID) if column // _RIGID == i else 0.0
    for c in range(size):
        total -= _reaction(workspace, face, c, rigid) * workspace.right[i * size + c, column]
    return total


@kernel
def _own(workspace, face, rigid, other):
    value = _reaction(workspace, face, rigid, other)
    if rigid > 0:
        value -= _beyond(workspace, face, rigid) * _reaction(workspace, face, 0, other)
    return value


@kernel
def _trace(compliance, faces, platform, payload, count, body, base):
    answers, number = compliance.workspace.answers, count * _RIGID
    for k in range(number):
        wrench = _wrench(
            compliance, faces, compliance.workspace.order[k // _RIGID], k % _RIGID, body, base
        )
        _answer_of_body(payload.inverse_inertia, body, wrench, answers[k, :_OF_PLATFORM])
        _answer_of_body(platform.inverse_inertia, base, wrench, answers[k, _OF_PLATFORM:])
    inverse_mass = 1.0 / payload.mass + 1.0 / platform.mass
    total = 0.0
    for k in range(number):
        for j in range(number):
            first, second = answers[k], answers[j]
            mobility = inverse_mass * _dot(first[_FORCE:], second[_FORCE:])
            mobility += _dot(first[_MOMENT:], second[_RATE:])
            mobility += _dot(first[_OF_PLATFORM + _MOMENT :], second[_OF_PLATFORM + _RATE :])
            total += _answer(compliance.workspace, k // _RIGID, k % _RIGID, j) * mobility
    return abs(total)


@kernel
def _trace_of_rest(compliance, faces, platform, payload, count, body, base):
    """Bound R (1/s2) of the trace of slopes of drawn walls that are not linear under a face; zero
    if all walls are straight."""
    if not drawn_walls.is_drawn(compliance.drawn):
        return 0.0
    total = 0.0
    for i in range(count):
        face = compliance.workspace.order[i]
        ahead, aside = drawn_slopes.rest(compliance, face)
        point, side = pad_point(faces[face], body), along_width(faces[face], 1.0)
        onward = rotation.rotate(base.turn, (1.0, 0.0, 0.0))
        sideways = rotation.rotate(base.turn, side)
        size = ahead * np.sqrt(inverse_mass(platform, payload, body, base, point, onward))
        size += (
            aside
            / abs(compliance.half[face, 1])
            * np.sqrt(inverse_mass(platform, payload, body, base, point, sideways))
        )
        total += compliance.workspace.stiffness[face, 0, 0] * size * size
    return total


@kernel
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def _answer_of_body(inverse_inertia, body, wrench, out):
    """Force, moment about the mass centre, and the angular acceleration of the body."""
    moment = _moment(body, wrench)
    rate = rotation.angular_velocity(body.turn, inverse_inertia, moment)
    for i in range(3):
        out[_FORCE + i], out[_MOMENT + i], out[_RATE + i] = wrench[0][i], moment[i], rate[i]


@kernel
def _wrench(compliance, faces, face, rigid, body, base):
    """Force, its point of action (m), and couple of a rigid motion of the face."""
    n, half = outward(faces[face], base), compliance.half[face]
    size = _by_slope(compliance.workspace, face, rigid)
    size += drawn_slopes.across(compliance, face)[rigid]
    across = along_width(faces[face], -size / half[1])
    aside = rotation.rotate(
        base.turn,
        (across[0] - drawn_slopes.along(compliance, face)[rigid], across[1], across[2]),
    )
    if rigid == 0:
        return (
            (n[0] + aside[0], n[1] + aside[1], n[2] + aside[2]),
            pad_point(faces[face], body),
            (0.0, 0.0, 0.0),
        )
    edge = along_width(faces[face], half[1]) if rigid == 2 else (half[0], 0.0, 0.0)
    return aside, pad_point(faces[face], body), rotation.cross(rotation.rotate(body.turn, edge), n)


@kernel
def _by_slope(workspace, face, rigid):
    """Slope of the wall across the rail under a rigid motion."""
    u, lever = workspace.displacement[face], workspace.lever[face]
    x, y, total = lever[SHIFT], lever[ASIDE], 0.0
    for n in range(1, len(workspace.levels)):
        for j in range(1, n + 1):
            i = n - j
            amount = j * u[patterns.number(i, j)]
            if rigid == 0:
                total += amount * x**i * y ** (j - 1)
            elif rigid == 1 and i > 0:
                total += amount * i * x ** (i - 1) * y ** (j - 1)
            elif rigid == 2 and j > 1:
                total += amount * (j - 1) * x**i * y ** (j - 2)
    return total


@kernel
def _moment(body, wrench):
    p, q = wrench[1], body.place
    swing = rotation.cross((p[0] - q[0], p[1] - q[1], p[2] - q[2]), wrench[0])
    return (swing[0] + wrench[2][0], swing[1] + wrench[2][1], swing[2] + wrench[2][2])
