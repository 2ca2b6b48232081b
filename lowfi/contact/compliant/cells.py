"""Pressure of one crowned pad face on its wall, cell by cell.

With the lever (p_0, a, b) of the rigid face, the displacement U of its wall
(``mechanics.rail_compliance``) and the interface stiffness k (N/m3), in the middle of each cell::

    p = p_0 + a xi + b eta - relief (xi^4 + eta^4) - sum_a U_a phi_a(xi', eta') - W(X, eta')
    pressure = k max(0, p)

where W is the offset as drawn of a wall that is not straight (``drawn_walls``) at the place X of
the cell, the crown is its mean over the cell, and xi' = xi + shift, eta' = eta + aside is the place
on the wall. The compliance is that of pads midway between all rails; 0.25 mm aside, the leg of an
L, held along one edge only, is three percent softer or stiffer. shift is not zero on a payload that is
turned: then the pad is not at its place by the travel. Cells divide the part of the face that is
over the wall.
"""

import numpy as np

from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi.contact.compliant import drawn_walls, patterns
from tipoff.lowfi.contact.compliant.record import (
    ASIDE,
    BY_ETA,
    BY_XI,
    DEPTH,
    MIDDLE,
    PART,
    SHIFT,
    SPAN,
)
from tipoff.lowfi.contact.springs import along, penetration_of_straight
from tipoff.lowfi.faces import NORMAL_Y, NORMAL_Z


@kernel
def take_lever(compliance, faces, face, place, turn):
    """Fill the face's lever for the payload's pose in platform axes."""
    lever, half = compliance.workspace.lever[face], compliance.half[face]
    y, z = faces[face, NORMAL_Y], faces[face, NORMAL_Z]
    lever[DEPTH] = penetration_of_straight(faces[face], place, turn)
    lever[BY_XI] = half[0] * (y * turn[3] + z * turn[6])
    # a face along y is wide along z, and the other way round
    lever[BY_ETA] = half[1] * (y * turn[5] + z * turn[7])
    middle = along(faces[face], place, turn)
    lever[MIDDLE] = middle
    lever[SHIFT] = (middle - place[0] - faces[face, 0]) / half[0]
    over_start = min(max(-1.0, (compliance.start - middle) / half[0]), 1.0)
    over_end = max(-1.0, min((compliance.end - middle) / half[0], 1.0))
    lever[PART], lever[SPAN] = 0.5 * (over_start + over_end), 0.5 * (over_end - over_start)
    first = 6 if z == 0.0 else 3  # of the row of the turn for the axis across the rail
    across = (
        place[first // 3]
        + turn[first] * faces[face, 0]
        + turn[first + 1] * faces[face, 1]
        + turn[first + 2] * faces[face, 2]
    )
    lever[ASIDE] = (across - compliance.across[face]) / half[1]


@kernel
def row_place(compliance, face, row):
    """xi of a row of cells, half its length in xi, and the mean of xi^4 over it. The rows divide the
    part of the face that is over the wall, so no row leaves the wall; off the wall, all of it."""
    middle, span = compliance.workspace.lever[face, PART], compliance.workspace.lever[face, SPAN]
    if span == 0.0:
        middle, span = 0.0, 1.0
    xi, half = middle + span * compliance.node[row], span / compliance.node.size
    square, wide = xi * xi, half * half
    return xi, half, square * square + 2.0 * square * wide + 0.2 * wide * wide


@kernel
def cell_stiffness(compliance, face):
    """Stiffness (N/m) of a cell; zero if no part of the face is over the wall."""
    half, count = compliance.half[face], compliance.node.size
    share = compliance.workspace.lever[face, SPAN]
    return compliance.interface_stiffness * 4.0 * half[0] * abs(half[1]) * share / (count * count)


@inlined
def fill_row(compliance, face, xi, displacement):
    """Fill ``Workspace.row`` with the coefficients of the powers of eta' in p (m) along the row of
    cells at ``xi``, without the crown across it."""
    workspace, lever = compliance.workspace, compliance.workspace.lever[face]
    row, degree = workspace.row, patterns.degree(workspace.levels)
    x = xi + lever[SHIFT]
    for j in range(degree + 1):
        total = 0.0
        for i in range(degree - j, -1, -1):
            total = total * x + displacement[patterns.number(i, j)]
        row[j] = -total
    if degree < 2:
        row[2] = 0.0
    w = drawn_walls.height(compliance.drawn, face, _place(compliance, face, xi))
    row[0] += lever[DEPTH] + lever[BY_XI] * xi - lever[BY_ETA] * lever[ASIDE] - w[0]
    row[1] += lever[BY_ETA] - w[1]
    row[2] -= w[2]


@inlined
def along_row(workspace, eta):
    """p (m) at eta' of the filled row."""
    row = workspace.row
    return row[0] + eta * (row[1] + eta * (row[2] + _beyond(workspace, eta)))


@inlined
def _beyond(workspace, eta):
    """Terms of the third and higher powers of eta', over eta'^2."""
    total = 0.0
    for j in range(patterns.degree(workspace.levels), 2, -1):
        total = (total + workspace.row[j]) * eta
    return total


@kernel
def _place(compliance, face, xi):
    """X (m) of a row of cells."""
    return compliance.workspace.lever[face, MIDDLE] + compliance.half[face, 0] * xi


@kernel
def press(compliance, face):
    """Fill the face's force (p,) N and stiffness (p, p) N/m. Returns the smallest |p| (m) of all
    cells over the wall: the same cells press while p changes by less."""
    workspace, relief = compliance.workspace, compliance.relief[face]
    lever, weight, slack = workspace.lever[face], cell_stiffness(compliance, face), np.inf
    _clear(workspace, face)
    if weight > 0.0:
        for number in range(compliance.node.size):
            xi, _, crown = row_place(compliance, face, number)
            fill_row(compliance, face, xi, workspace.displacement[face])
            workspace.row[0] -= relief * crown
            slack = min(slack, _sum_row(compliance, relief, lever[ASIDE]))
            if workspace.counted[0] > 0.0:
                _add_row(workspace, face, xi + lever[SHIFT], weight)
    _fill_stiffness(workspace, face)
    return slack


@inlined
def _clear(workspace, face):
    """Set force and moments to zero."""
    for a in range(patterns.count(workspace.levels)):
        workspace.force[face, a] = 0.0
    size = 2 * patterns.degree(workspace.levels) + 1
    for i in range(size):
        for j in range(size - i):
            workspace.moments[i, j] = 0.0


@inlined
def _sum_row(compliance, relief, aside):
    """Fill sums over the pressed cells of the filled row: of eta'^j and of p eta'^j. Returns the
    smallest |p| (m)."""
    workspace, slack = compliance.workspace, np.inf
    degree = patterns.degree(workspace.levels)
    counted, pressed = workspace.counted, workspace.pressed
    for j in range(2 * degree + 1):
        counted[j] = 0.0
    for j in range(degree + 1):
        pressed[j] = 0.0
    # read before the loop, in which sums are written
    level, tilt, bend = workspace.row[0], workspace.row[1], workspace.row[2]
    for column in range(compliance.node.size):
        eta = compliance.node[column] + aside
        p = level + eta * (tilt + eta * (bend + _beyond(workspace, eta)))
        p -= relief * compliance.crown[column]
        slack = min(slack, abs(p))
        if p > 0.0:
            power = 1.0
            for j in range(2 * degree + 1):
                counted[j] += power
                if j <= degree:
                    pressed[j] += p * power
                power *= eta
    return slack


@inlined
def _add_row(workspace, face, x, weight):
    """Add the sums of a row at xi' = ``x``, times its ``weight`` (N/m), to the force and to the
    moments: sums over pressed cells of k dA xi'^i eta'^j with i + j up to twice the degree."""
    degree, moments = patterns.degree(workspace.levels), workspace.moments
    factor = weight
    for i in range(2 * degree + 1):
        for j in range(2 * degree + 1 - i):
            moments[i, j] += factor * workspace.counted[j]
        for j in range(degree + 1 - i):
            workspace.force[face, patterns.number(i, j)] += factor * workspace.pressed[j]
        factor *= x


@inlined
def _fill_stiffness(workspace, face):
    """K_ab from the moments."""
    levels = workspace.levels
    for n in range(len(levels)):
        for j in range(n + 1):
            row = workspace.stiffness[face, patterns.number(n - j, j)]
            for m in range(len(levels)):
                for i in range(m + 1):
                    row[patterns.number(m - i, i)] = workspace.moments[n - j + m - i, j + i]


@kernel
def largest_change(compliance, face, change):
    """Bound (m) of the change of p in all cells of a face for a ``change`` (p,) of the displacement
    of its wall."""
    lever, levels = compliance.workspace.lever[face], compliance.workspace.levels
    xi, eta = 1.0 + abs(lever[SHIFT]), 1.0 + abs(lever[ASIDE])
    total, across = 0.0, 1.0
    for j in range(len(levels)):
        along = 0.0
        for i in range(patterns.degree(levels) - j, -1, -1):
            along = along * xi + abs(change[patterns.number(i, j)])
        total += along * across
        across *= eta
    return total


@kernel
def stored(compliance, face):
    """Energy (J) in the interface of the face."""
    relief, stiffness = compliance.relief[face], cell_stiffness(compliance, face)
    energy = 0.0
    if stiffness > 0.0:
        for row in range(compliance.node.size):
            xi, _, crown = row_place(compliance, face, row)
            fill_row(compliance, face, xi, compliance.workspace.displacement[face])
            for column in range(compliance.node.size):
                eta = compliance.node[column] + compliance.workspace.lever[face, ASIDE]
                p = along_row(compliance.workspace, eta) - relief * (
                    crown + compliance.crown[column]
                )
                energy += 0.5 * stiffness * max(0.0, p) ** 2
    return energy


@kernel
def push_of_end(compliance, face):
    """Force (N) along the rail on a face that overhangs an end: the decrease of its energy per metre
    of travel as the part over the wall, and the rows with it, become shorter."""
    total, stiffness = 0.0, cell_stiffness(compliance, face)
    moved, grown = _drift_of_part(compliance, face)
    if stiffness > 0.0 and moved != 0.0:
        for row in range(compliance.node.size):
            total -= stiffness * _change_of_row(compliance, face, row, moved, grown)
    return total


@kernel
def _drift_of_part(compliance, face):
    """Rates at which the middle of the part over the wall moves in xi, and its half length grows, per
    metre of travel; zeros on a face that is completely over the wall or off it."""
    lever, half = compliance.workspace.lever[face], compliance.half[face, 0]
    at_end, at_start = 0.0, 0.0
    if 0.0 < lever[SPAN] < 1.0:
        at_end = 1.0 if lever[MIDDLE] + half > compliance.end else 0.0
        at_start = 1.0 if lever[MIDDLE] - half < compliance.start else 0.0
    return -0.5 * (at_end + at_start) / half, -0.5 * (at_end - at_start) / half


@kernel
def drift_of_depth(compliance, face, xi, eta):
    """Change of p per metre of travel in a cell of a face that overhangs an end, because the cells
    follow the part over the wall."""
    moved, grown = _drift_of_part(compliance, face)
    change = 0.0
    if moved != 0.0:
        lever, u = compliance.workspace.lever[face], compliance.workspace.displacement[face]
        slope = lever[BY_XI] - 4.0 * compliance.relief[face] * xi * xi * xi
        levels = compliance.workspace.levels
        slope -= patterns.by_xi(levels, u, xi + lever[SHIFT], eta + lever[ASIDE])
        change = slope * (moved + grown * (xi - lever[PART]) / lever[SPAN])
    return change


@kernel
def _change_of_row(compliance, face, row, moved, grown):
    """Change of the sum of p^2 / 2 over a row, per metre of travel, while the middle of the part over
    the wall moves by ``moved`` in xi and its half length grows by ``grown``."""
    lever, u = compliance.workspace.lever[face], compliance.workspace.displacement[face]
    relief, place = compliance.relief[face], compliance.node[row]
    xi, half, crown = row_place(compliance, face, row)
    fill_row(compliance, face, xi, u)
    ahead = drawn_walls.slope(compliance.drawn, face, _place(compliance, face, xi))
    away, x = compliance.half[face, 0], xi + lever[SHIFT]
    onward = moved + grown * place
    by_crown = relief * (4.0 * xi * (xi * xi + half * half) * onward)
    by_crown += relief * half * (4.0 * xi * xi + 0.8 * half * half) * grown / compliance.node.size
    total = 0.0
    for column in range(compliance.node.size):
        eta = compliance.node[column] + lever[ASIDE]
        p = along_row(compliance.workspace, eta) - relief * (crown + compliance.crown[column])
        if p > 0.0:
            slope = lever[BY_XI] - patterns.by_xi(compliance.workspace.levels, u, x, eta)
            slope -= away * (ahead[0] + eta * (ahead[1] + eta * ahead[2]))
            change = onward * slope - by_crown
            total += p * (change + 0.5 * p * grown / lever[SPAN])
    return total


@kernel
def push_of_drawn_slopes(compliance, face):
    """Force (N) along the rail, and generalised force (N m) per eta, on the face due to the slopes
    of a wall as drawn; zeros if all walls are straight."""
    if drawn_walls.is_drawn(compliance.drawn):
        return _push_of_slopes(compliance, face)
    return 0.0, 0.0


@kernel
def _push_of_slopes(compliance, face):
    lever, relief = compliance.workspace.lever[face], compliance.relief[face]
    along, across, stiffness = 0.0, 0.0, cell_stiffness(compliance, face)
    if stiffness > 0.0:
        for row in range(compliance.node.size):
            xi, _, crown = row_place(compliance, face, row)
            fill_row(compliance, face, xi, compliance.workspace.displacement[face])
            x, f0, f1, f2 = _place(compliance, face, xi), 0.0, 0.0, 0.0
            for column in range(compliance.node.size):
                eta = compliance.node[column] + lever[ASIDE]
                p = max(
                    0.0,
                    along_row(compliance.workspace, eta)
                    - relief * (crown + compliance.crown[column]),
                )
                f0, f1, f2 = f0 + p, f1 + p * eta, f2 + p * eta * eta
            ahead = drawn_walls.slope(compliance.drawn, face, x)
            aside = drawn_walls.height(compliance.drawn, face, x)
            along += stiffness * (ahead[0] * f0 + ahead[1] * f1 + ahead[2] * f2)
            across += stiffness * (aside[1] * f0 + 2.0 * aside[2] * f1)
    return along, across


@kernel
def drawn_slope(compliance, face, xi, eta):
    """Slope along the rail of the wall as drawn under a point of the face; zero if all walls are
    straight."""
    ahead = drawn_walls.slope(compliance.drawn, face, _place(compliance, face, xi))
    aside = eta + compliance.workspace.lever[face, ASIDE]
    return ahead[0] + aside * (ahead[1] + aside * ahead[2])
