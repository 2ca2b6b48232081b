"""Displacement of the walls of one rail under the faces that press it, by Newton's method on
piecewise linear equations.

    U = T + F P(U) + W q,    (1 + F K) dU = T + F P + W q - U,
    K_iab = dP_ia/d(-U_ib) = sum over pressed cells of penalty dA phi_a phi_b

W q is what the rail's modes make of it (``lowfi.contact.compliant.modes``), F the rest; without modes there is
only F. T is where walls stand that are warm (``lowfi.contact.compliant.thermal_offset``), zero otherwise. P is the
gradient of a convex potential, so the solution is one; while the pressed cells do not change the
equations are linear, and the last correction is exact. The displacement of the solution before is
the first guess.
"""

import numpy as np

from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi.contact.compliant import thermal_offset
from tipoff.lowfi.contact.compliant.cells import eased, press, take_lever
from tipoff.lowfi.contact.compliant.modes import offset, take_swing
from tipoff.mechanics.rail_compliance import PATTERNS, POWERS

_ARRIVED = 1e-14  # m, a correction that is rounding
_MOST = 60  # corrections
_CAREFUL = 12  # after so many only half of each is taken, so that none can go round in circles
_XI, _ETA = POWERS.T.copy()


@kernel
def solve(compliance, faces, rail, active, place, turn, state):
    """Number of ``active`` (f,) faces on ``rail``; ``walls.room`` holds them in ``order``, with
    lever, displacement and force. Of ``state`` only the modes are read."""
    room, count = compliance.room, 0
    for slot in range(compliance.members.shape[1]):
        face = compliance.members[rail, slot]
        if face >= 0 and active[face]:
            take_lever(compliance, faces, face, place, turn)
            room.order[count] = face
            count += 1
    if count > 0:
        take_flexibility(compliance, count, place[0] + faces[0, 0], state)
        for correction in range(_MOST):
            if _correct(compliance, count, 1.0 if correction < _CAREFUL else 0.5) < _ARRIVED:
                return count
        room.force[:] = np.nan  # never seen; no step could stand on it
    return count


@inlined
def between_stations(compliance, place):
    """Number of the station before X = ``place`` (m) of the first face, the way (m) from it, inside
    the table, and by how much that changes with the place: at the last station it stops as the
    places of pads on the wall do at the end of the rail."""
    half = compliance.half[0, 0]
    over, rate = eased(
        (place - compliance.origin - compliance.spacing * compliance.cubic.shape[0]) / half
    )
    way, changes = place - compliance.origin - half * over, 1.0 - rate
    if way < 0.0:
        way, changes = 0.0, 0.0
    station = min(int(way / compliance.spacing), compliance.cubic.shape[0] - 1)
    return station, way - station * compliance.spacing, changes


@kernel
def take_flexibility(compliance, count, place, state):
    """Fill flexibility and slope between the first ``count`` faces in order, and what the modes are
    under them."""
    room = compliance.room
    station, s, changes = between_stations(compliance, place)
    for i in range(count):
        take_swing(
            compliance.modes,
            compliance.rail[room.order[i]],
            room.order[i],
            station,
            s,
            changes,
            state,
        )
        thermal_offset.take(compliance.warm, room.order[i], station, s, changes)
        for j in range(count):
            block = compliance.cubic[station, room.order[i], room.order[j]]
            for a in range(PATTERNS):
                for b in range(PATTERNS):
                    c = block[a, b]
                    room.flexibility[i * PATTERNS + a, j * PATTERNS + b] = c[0] + s * (
                        c[1] + s * (c[2] + s * c[3])
                    )
                    room.slope[i * PATTERNS + a, j * PATTERNS + b] = changes * (
                        c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])
                    )


@inlined
def stiffness(moment, a, b):
    """K_ab of one face."""
    return moment[_XI[a] + _XI[b], _ETA[a] + _ETA[b]]


@kernel
def _correct(compliance, count, share):
    """Take ``share`` of one correction; its largest size (m)."""
    room = compliance.room
    for i in range(count):
        press(compliance, room.order[i])
    wide = count * PATTERNS
    fill_matrix(room, count)
    for row in range(wide):
        total = 0.0
        for column in range(wide):
            total += (
                room.flexibility[row, column]
                * room.force[room.order[column // PATTERNS], column % PATTERNS]
            )
        face, a = room.order[row // PATTERNS], row % PATTERNS
        room.right[row, 0] = total - (
            room.displacement[face, a]
            - thermal_offset.place(compliance.warm, face, a)
            - offset(compliance.modes, face, a)
        )
    eliminate(room.matrix, room.right, wide, 1)
    largest = 0.0
    for i in range(count):
        face = room.order[i]
        for a in range(PATTERNS):
            change = share * room.right[i * PATTERNS + a, 0]
            largest = max(largest, abs(change))
            room.displacement[face, a] += change
            for b in range(PATTERNS):
                room.force[face, b] -= stiffness(room.moment[face], a, b) * change
    return largest if largest == largest else 0.0  # what is not a number stays so


@kernel
def fill_matrix(room, count):
    """1 + F K over the first ``count`` faces in order."""
    wide = count * PATTERNS
    for row in range(wide):
        for j in range(count):
            moment = room.moment[room.order[j]]
            for b in range(PATTERNS):
                total = 1.0 if row == j * PATTERNS + b else 0.0
                for c in range(PATTERNS):
                    total += room.flexibility[row, j * PATTERNS + c] * stiffness(moment, c, b)
                room.matrix[row, j * PATTERNS + b] = total


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
        for row in range(k + 1, size):
            factor = matrix[row, k] / matrix[k, k]
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
    """Fill ``out`` (p,) with the displacement of the wall under a face that may not press, by the
    ``count`` faces solved for and by modes."""
    room = compliance.room
    station, s, changes = between_stations(compliance, place)
    take_swing(compliance.modes, compliance.rail[face], face, station, s, changes, state)
    thermal_offset.take(compliance.warm, face, station, s, changes)
    for a in range(PATTERNS):
        out[a] = thermal_offset.place(compliance.warm, face, a) + offset(compliance.modes, face, a)
        for j in range(count):
            other = room.order[j]
            for b in range(PATTERNS):
                c = compliance.cubic[station, face, other, a, b]
                out[a] += (c[0] + s * (c[1] + s * (c[2] + s * c[3]))) * room.force[other, b]
