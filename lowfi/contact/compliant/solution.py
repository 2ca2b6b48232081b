"""Displacement of the walls of one rail under the faces that press on it, by Newton's method on
piecewise linear equations.

    U = T + F P(U) + S q,    (1 + F K) dU = T + F P + S q - U,
    K_iab = dP_ia/d(-U_ib) = sum over pressed cells of k dA phi_a phi_b

F is the flexibility without the modes, plus what friction of the payload that slides forward adds
(``Workspace.friction`` times D_res of ``mechanics.rail_compliance``), S q the displacement of the modes
(``lowfi.contact.compliant.modes``), T the thermal offset
(``lowfi.contact.compliant.thermal_offset``). P is the gradient of a convex potential, so the
solution is unique. While the set of pressed cells does not change, the equations are linear and a
full correction is exact: it is the last one if it cannot change the set. A face without a pressed cell
has no K: the equations of the others are solved without it, and the change of their forces moves its
wall. The first guess is the previous displacement, moved with the pad as at the end of the last step
(``lowfi.contact.compliant.step_limit``)."""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import modes, parts, patterns, thermal_offset
from tipoff.lowfi.contact.compliant.cells import largest_change, press, take_lever
from tipoff.lowfi.contact.compliant.record import BY_ETA, BY_XI, DEPTH
from tipoff.mechanics.rail_compliance.patterns import DRAGGED

_ARRIVED = 1e-14  # m; a smaller correction is rounding
_MOST = 60  # corrections
_CAREFUL = 12  # corrections; later ones are halved, which prevents cycles


@kernel
def solve(compliance, faces, rail, touching, place, turn, state):
    """Solve under the ``touching`` (f,) faces on ``rail``; returns their number.
    ``compliance.workspace`` has them in ``order``, with lever, displacement and force. Only the
    modes are read from ``state``."""
    workspace, count = compliance.workspace, gather(compliance, rail, touching)
    for i in range(count):
        _move(compliance, faces, workspace.order[i], place, turn)
    if count > 0:
        take_flexibility(compliance, count, place[0] + faces[0, 0], state)
        for correction in range(_MOST):
            if _correct(compliance, count, 1.0 if correction < _CAREFUL else 0.5) < _ARRIVED:
                return count
        workspace.force[:] = np.nan  # no convergence; the step will be rejected
    return count


@kernel
def _move(compliance, faces, face, place, turn):
    """Fill the lever of a face, and guess the displacement of its wall; a state that is not finite
    changes nothing."""
    lever, displacement = compliance.workspace.lever[face], compliance.workspace.displacement[face]
    depth, by_xi, by_eta = lever[DEPTH], lever[BY_XI], lever[BY_ETA]
    take_lever(compliance, faces, face, place, turn)
    yielding, size = (
        compliance.workspace.yielding[face],
        patterns.count(compliance.workspace.levels),
    )
    depth, by_xi, by_eta = lever[DEPTH] - depth, lever[BY_XI] - by_xi, lever[BY_ETA] - by_eta
    for a in range(size):
        moved = depth * yielding[0, a] + by_xi * yielding[1, a] + by_eta * yielding[2, a]
        guess = displacement[a] + moved
        displacement[a] = guess if abs(guess) < np.inf else 0.0


@kernel
def gather(compliance, rail, touching):
    """Fill ``order`` with the ``touching`` (f,) faces on ``rail``; returns their number."""
    count = 0
    for slot in range(compliance.members.shape[1]):
        face = compliance.members[rail, slot]
        if face >= 0 and touching[face]:
            compliance.workspace.order[count] = face
            count += 1
    return count


@kernel
def solve_unless(solved, compliance, faces, rail, touching, place, turn, state):
    """``solve``; if all rails are already ``solved`` at this ``state``, only the number of faces
    and their order."""
    if solved:
        return gather(compliance, rail, touching)
    return solve(compliance, faces, rail, touching, place, turn, state)


@kernel
def between_stations(compliance, place):
    """Number of the station before X = ``place`` (m) of the first face, the distance (m) from it,
    limited to the table, and its derivative by the place."""
    way, changes = place - compliance.origin, 1.0
    longest = compliance.spacing * compliance.cubic.shape[0]
    if not 0.0 <= way <= longest:  # also where the place is not a number
        way, changes = longest if way > longest else 0.0, 0.0
    station = min(int(way / compliance.spacing), compliance.cubic.shape[0] - 1)
    return station, way - station * compliance.spacing, changes


@kernel
def take_flexibility(compliance, count, place, state):
    """Fill flexibility and slope between the first ``count`` faces in order, and the modes under
    them."""
    workspace, over_end = compliance.workspace, False
    station, s, changes = between_stations(compliance, place)
    for i in range(count):
        over_end = _evaluate(compliance, workspace.order[i], place, state) or over_end
    for i in range(count):
        for j in range(count):
            face, slot = workspace.order[i], compliance.among[workspace.order[j]]
            if compliance.turned[face, slot]:
                _transpose(workspace, i, j)
                continue
            c = compliance.cubic[station, compliance.block[face, slot]]
            block, slope = workspace.flexibility[i, j], workspace.slope[i, j]
            for k in range(block.size):
                block[k] = c[0, k] + s * (c[1, k] + s * (c[2, k] + s * c[3, k]))
                slope[k] = changes * (c[1, k] + s * (2.0 * c[2, k] + s * 3.0 * c[3, k]))
            _add_drag(compliance, workspace, i, j, station, s, changes)
            if over_end:
                other = workspace.order[j]
                parts.block_to_whole(
                    workspace.levels, workspace.part[face], workspace.part[other], block, slope
                )


@kernel
def _transpose(workspace, i, j):
    """Fill flexibility and slope between two faces in order from those between j, an earlier face, and
    i."""
    size = patterns.count(workspace.levels)
    for a in range(size):
        for b in range(size):
            k, n = a * size + b, b * size + a
            workspace.flexibility[i, j, k] = workspace.flexibility[j, i, n]
            workspace.slope[i, j, k] = workspace.slope[j, i, n]


@kernel
def _evaluate(compliance, face, place, state):
    """Fill the part of a face, and thermal offset and modes under it; returns whether it is not
    completely over the wall."""
    station, s, changes = between_stations(compliance, place)
    at = compliance.origin + station * compliance.spacing + s
    over_end, part = parts.take(compliance, face, at, changes), compliance.workspace.part[face]
    rail = compliance.rail[face]
    modes.evaluate(compliance.modes, rail, face, station, s, changes, state)
    thermal_offset.evaluate(compliance.thermal_offset, face, station, s, changes)
    if over_end:
        modes.to_whole(compliance.modes, face, part)
        thermal_offset.to_whole(compliance.thermal_offset, face, part)
    return over_end


@kernel
def _add_drag(compliance, workspace, i, j, station, s, changes):
    """Add what friction adds to flexibility and slope between two faces in order."""
    if compliance.dragged.shape[0] > 0:
        slot = compliance.among[workspace.order[j]]
        c = compliance.dragged[station, compliance.block[workspace.order[i], slot]]
        share, size = workspace.friction[0], patterns.count(workspace.levels)
        for a in range(DRAGGED):
            for b in range(DRAGGED):
                k, n = a * DRAGGED + b, a * size + b
                workspace.flexibility[i, j, n] += share * (
                    c[0, k] + s * (c[1, k] + s * (c[2, k] + s * c[3, k]))
                )
                workspace.slope[i, j, n] += (
                    share * changes * (c[1, k] + s * (2.0 * c[2, k] + s * 3.0 * c[3, k]))
                )


@kernel
def _follow_drag(compliance, workspace, face, slot, station, s, out):
    """Add to ``out`` the displacement of the wall under a face by the friction of the one in a ``slot``,
    from the forces in ``own``."""
    if compliance.dragged.shape[0] > 0:
        c = compliance.dragged[station, compliance.block[face, slot]]
        share, turned = workspace.friction[0], compliance.turned[face, slot]
        for a in range(DRAGGED):
            for b in range(DRAGGED):
                k = b * DRAGGED + a if turned else a * DRAGGED + b
                value = c[0, k] + s * (c[1, k] + s * (c[2, k] + s * c[3, k]))
                out[a] += share * value * workspace.own[b]


@kernel
def _correct(compliance, count, share):
    """Apply ``share`` of one correction; returns its largest size (m), zero if it is exact."""
    workspace, size = compliance.workspace, patterns.count(compliance.workspace.levels)
    for i in range(count):
        workspace.slack[i] = press(compliance, workspace.order[i])
    pressed = take_pressed(workspace, count)
    _fill_left(compliance, count)
    fill_matrix(workspace, pressed)
    for i in range(pressed):
        for a in range(size):
            workspace.right[i * size + a, 0] = workspace.change[workspace.pressing[i], a]
    eliminate(workspace.matrix, workspace.right, pressed * size, 1)
    for i in range(pressed):
        for a in range(size):
            workspace.change[workspace.pressing[i], a] = workspace.right[i * size + a, 0]
    _follow_pressed(workspace, count, pressed)
    largest, exact = 0.0, share == 1.0
    for i in range(count):
        face = workspace.order[i]
        changes = workspace.change[i]
        exact = exact and largest_change(compliance, face, changes) < workspace.slack[i]
        for a in range(size):
            change = share * changes[a]
            largest = max(largest, abs(change))
            workspace.displacement[face, a] += change
            for b in range(size):
                workspace.force[face, b] -= workspace.stiffness[face, a, b] * change
    return 0.0 if exact or largest != largest else largest  # NaN in the displacement stays


@kernel
def take_pressed(workspace, count):
    """Fill ``pressing`` with the places in ``order`` of the first ``count`` faces that have a pressed
    cell, or values that are not finite; returns their number."""
    pressed = 0
    for i in range(count):
        if workspace.stiffness[workspace.order[i], 0, 0] != 0.0:
            workspace.pressing[pressed] = i
            pressed += 1
    return pressed


@kernel
def _fill_left(compliance, count):
    """Fill ``change`` with what is left of the equations: F P + T + S q - U."""
    workspace, size = compliance.workspace, patterns.count(compliance.workspace.levels)
    for i in range(count):
        face = workspace.order[i]
        for a in range(size):
            total = 0.0
            for j in range(count):
                force = workspace.force[workspace.order[j]]
                for c in range(size):
                    total += workspace.flexibility[i, j, a * size + c] * force[c]
            workspace.change[i, a] = total - (
                workspace.displacement[face, a]
                - thermal_offset.offset(compliance.thermal_offset, face, a)
                - modes.offset(compliance.modes, face, a)
            )


@kernel
def _follow_pressed(workspace, count, pressed):
    """Add to the ``change`` of the other faces what the ``pressed`` ones cause: -F K dU."""
    size, following = patterns.count(workspace.levels), 0
    for i in range(count):
        if following < pressed and workspace.pressing[following] == i:
            following += 1
            continue
        for j in workspace.pressing[:pressed]:
            block, stiffness = workspace.flexibility[i, j], workspace.stiffness[workspace.order[j]]
            for c in range(size):
                force = 0.0
                for b in range(size):
                    force += stiffness[c, b] * workspace.change[j, b]
                for a in range(size):
                    workspace.change[i, a] -= block[a * size + c] * force


@kernel
def fill_matrix(workspace, pressed):
    """1 + F K over the ``pressed`` faces."""
    size, pressing = patterns.count(workspace.levels), workspace.pressing
    for i in range(pressed):
        for j in range(pressed):
            block = workspace.flexibility[pressing[i], pressing[j]]
            stiffness = workspace.stiffness[workspace.order[pressing[j]]]
            for a in range(size):
                for b in range(size):
                    total = 1.0 if i == j and a == b else 0.0
                    for c in range(size):
                        total += block[a * size + c] * stiffness[c, b]
                    workspace.matrix[i * size + a, j * size + b] = total


@kernel
def eliminate(matrix, right, size, columns):
    """Solve for the first ``columns`` of ``right`` in place, by Gauss's method with partial
    pivoting."""
    for k in range(size):
        pivot = k
        for row in range(k + 1, size):
            if abs(matrix[row, k]) > abs(matrix[pivot, k]):
                pivot = row
        if pivot != k:
            for column in range(k, size):
                matrix[k, column], matrix[pivot, column] = matrix[pivot, column], matrix[k, column]
            for column in range(columns):
                right[k, column], right[pivot, column] = right[pivot, column], right[k, column]
        inverse = 1.0 / matrix[k, k]
        for row in range(k + 1, size):
            factor = matrix[row, k] * inverse
            for column in range(k + 1, size):
                matrix[row, column] -= factor * matrix[k, column]
            for column in range(columns):
                right[row, column] -= factor * right[k, column]
    for k in range(size - 1, -1, -1):
        for column in range(columns):
            total = right[k, column]
            for j in range(k + 1, size):
                total -= matrix[k, j] * right[j, column]
            right[k, column] = total / matrix[k, k]


@kernel
def follow(compliance, face, place, count, state, out):
    """Fill ``out`` (p,) with the displacement of the wall under a face that may not press, due to
    the ``count`` solved faces and the modes."""
    workspace, size = compliance.workspace, patterns.count(compliance.workspace.levels)
    station, s, _ = between_stations(compliance, place)
    over_end = _evaluate(compliance, face, place, state)
    out[:] = 0.0
    for j in range(count):
        other = workspace.order[j]
        parts.to_part(
            workspace.levels, workspace.part[other], workspace.force[other], workspace.own
        )
        slot = compliance.among[other]
        c, turned = (
            compliance.cubic[station, compliance.block[face, slot]],
            compliance.turned[face, slot],
        )
        for a in range(size):
            for b in range(size):
                k = b * size + a if turned else a * size + b
                value = c[0, k] + s * (c[1, k] + s * (c[2, k] + s * c[3, k]))
                out[a] += value * workspace.own[b]
        _follow_drag(compliance, workspace, face, slot, station, s, out)
    if over_end:
        parts.to_whole(workspace.levels, workspace.part[face], out, 0, 1)
    for a in range(size):
        out[a] += thermal_offset.offset(compliance.thermal_offset, face, a)
        out[a] += modes.offset(compliance.modes, face, a)
