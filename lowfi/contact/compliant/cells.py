"""Pressure of one crowned pad face on its wall, cell by cell.

With the lever (p_0, a, b) of the rigid face, the displacement U of its wall
(``mechanics.rail_compliance``) and the interface stiffness k (N/m3), in the middle of each cell::

    p = p_0 + a xi + b eta - relief (xi^4 + eta^4) - sum_a U_a phi_a(xi', eta') - W(X, eta')
    pressure = k max(0, p)

where W is the offset as drawn of a wall that is not straight (``drawn_walls``) at the place X of
the cell, the crown is its mean over the cell, and xi' = xi + shift, eta' = eta + aside is the place
on the wall. The compliance is that of pads midway between all rails; 0.25 mm aside, the leg of an
L, held along one edge only, is three percent softer or stiffer. Of a row of cells that overhangs an
end of the rail, only the part over the wall presses; sums are piecewise linear between the middles
of the rows.
"""

import numpy as np

from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi.contact.compliant import drawn_walls, patterns
from tipoff.lowfi.contact.compliant.record import (
    ASIDE,
    BY_ETA,
    BY_XI,
    DEPTH,
    DRIFT,
    MIDDLE,
    SHIFT,
)
from tipoff.lowfi.contact.springs import along, penetration
from tipoff.lowfi.faces import NORMAL_Y, NORMAL_Z

# in xi, half the travel over which the place of a pad on the wall slows down to rest while the pad
# begins to overhang an end
_EASED = 0.1


@kernel
def take_lever(compliance, faces, face, place, turn):
    """Fill the face's lever for the payload's pose in platform axes."""
    lever, half = compliance.workspace.lever[face], compliance.half[face]
    y, z = faces[face, NORMAL_Y], faces[face, NORMAL_Z]
    lever[DEPTH] = penetration(None, faces[face], place, turn)
    lever[BY_XI] = half[0] * (y * turn[3] + z * turn[6])
    # a face along y is wide along z, and the other way round
    lever[BY_ETA] = half[1] * (y * turn[5] + z * turn[7])
    middle = along(faces[face], place, turn)
    lever[MIDDLE] = middle
    over_end, by_end = eased((middle - compliance.end) / half[0] + 1.0)
    over_start, by_start = eased((compliance.start - middle) / half[0] + 1.0)
    lever[SHIFT], lever[DRIFT] = over_end - over_start, (by_end + by_start) / half[0]
    first = 6 if z == 0.0 else 3  # of the row of the turn for the axis across the rail
    across = (
        place[first // 3]
        + turn[first] * faces[face, 0]
        + turn[first + 1] * faces[face, 1]
        + turn[first + 2] * faces[face, 2]
    )
    lever[ASIDE] = (across - compliance.across[face]) / half[1]


@kernel
def eased(over):
    """max(``over``, 0) with a rounded corner, and its slope, which a force along the rail
    contains."""
    if abs(over) >= _EASED:
        return max(over, 0.0), 1.0 if over > 0.0 else 0.0
    return 0.25 * (over + _EASED) ** 2 / _EASED, 0.5 * (over + _EASED) / _EASED


@kernel
def cover(compliance, half, middle, row):
    """Share over the wall of a row of cells, and its decrease per metre of travel."""
    behind_end, at_end = _behind(compliance, row, (compliance.end - middle) / half)
    behind_start, at_start = _behind(compliance, row, (compliance.start - middle) / half)
    return behind_end - behind_start, (at_end - at_start) / half


@kernel
def _behind(compliance, row, xi):
    """Share of a row of cells behind an end of the rail at ``xi``, and its slope. The sums of
    neighbouring rows change linearly from middle to middle, so the rate of lost energy does not
    jump."""
    away = 0.5 * compliance.node.size * (xi - compliance.node[row])  # in cells
    outermost = row == 0 if away < 0.0 else row == compliance.node.size - 1
    reach = 0.5 if outermost else 1.0
    near = min(abs(away), reach)
    part = near if outermost else near - 0.5 * near * near
    slope = (1.0 if outermost else 1.0 - near) if near < reach else 0.0
    return 0.5 + part if away > 0.0 else 0.5 - part, 0.5 * compliance.node.size * slope


@inlined
def fill_row(compliance, face, xi, displacement):
    """Fill ``Workspace.row`` with the coefficients of the powers of eta' in p (m) along the row of
    cells at ``xi``, without the crown across it. A row beyond the wall continues its last one."""
    workspace, lever = compliance.workspace, compliance.workspace.lever[face]
    row, degree = workspace.row, patterns.degree(workspace.levels)
    x = xi + lever[SHIFT]
    if lever[SHIFT] != 0.0:  # rows over the wall are within this distance
        edge = 1.0 + 2.0 / compliance.node.size
        x = min(max(x, -edge), edge)
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
    workspace, half, relief = compliance.workspace, compliance.half[face], compliance.relief[face]
    lever, count = workspace.lever[face], compliance.node.size
    stiffness = compliance.interface_stiffness * 4.0 * half[0] * abs(half[1]) / (count * count)
    slack = np.inf
    _clear(workspace, face)
    for number in range(count):
        xi, weight = compliance.node[number], stiffness
        if lever[DRIFT] != 0.0:  # else all of the face is over the wall
            weight *= cover(compliance, half[0], lever[MIDDLE], number)[0]
        if weight > 0.0:
            fill_row(compliance, face, xi, workspace.displacement[face])
            workspace.row[0] -= relief * compliance.crown[number]
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
def deepest(compliance, face, displacement):
    """Largest p (m) of all cells, over the wall or its continuation, and xi and eta of that cell on
    the pad."""
    aside, relief, largest, along, across = (
        compliance.workspace.lever[face, ASIDE],
        compliance.relief[face],
        -np.inf,
        0.0,
        0.0,
    )
    for row in range(compliance.node.size):
        fill_row(compliance, face, compliance.node[row], displacement)
        for column in range(compliance.node.size):
            eta = compliance.node[column] + aside
            p = along_row(compliance.workspace, eta) - relief * (
                compliance.crown[row] + compliance.crown[column]
            )
            if p > largest:
                largest, along, across = p, compliance.node[row], compliance.node[column]
    return largest, along, across


@kernel
def deepest_at_rest(compliance, face):
    """As ``deepest`` for a wall without displacement: p is then a sum of a part along and a part
    across the pad."""
    lever, relief = compliance.workspace.lever[face], compliance.relief[face]
    along, across, by_xi, by_eta = 0.0, 0.0, -np.inf, -np.inf
    for i in range(compliance.node.size):
        place, crown = compliance.node[i], relief * compliance.crown[i]
        if lever[BY_XI] * place - crown > by_xi:
            along, by_xi = place, lever[BY_XI] * place - crown
        if lever[BY_ETA] * place - crown > by_eta:
            across, by_eta = place, lever[BY_ETA] * place - crown
    return lever[DEPTH] + by_xi + by_eta, along, across


@kernel
def stored(compliance, face):
    """Energy (J) in the interface of the face, and its decrease per metre of travel (N) as the face
    slides over an end of the rail."""
    lever, relief, half = (
        compliance.workspace.lever[face],
        compliance.relief[face],
        compliance.half[face],
    )
    count = compliance.node.size
    stiffness = compliance.interface_stiffness * 4.0 * half[0] * abs(half[1]) / (count * count)
    energy, fading = 0.0, 0.0
    for row in range(count):
        xi = compliance.node[row]
        share, lost = cover(compliance, half[0], lever[MIDDLE], row)
        if share > 0.0:
            fill_row(compliance, face, xi, compliance.workspace.displacement[face])
            squares = 0.0
            for column in range(count):
                eta = compliance.node[column] + lever[ASIDE]
                p = max(
                    0.0,
                    along_row(compliance.workspace, eta)
                    - relief * (compliance.crown[row] + compliance.crown[column]),
                )
                squares += p * p
            energy += 0.5 * stiffness * share * squares
            fading += 0.5 * stiffness * lost * squares
    return energy, fading


@kernel
def push_of_drawn_slopes(compliance, face):
    """Force (N) along the rail, and generalised force (N m) per eta, on the face due to the slopes
    of a wall as drawn; zeros if all walls are straight."""
    if compliance.drawn is not None:
        return _push_of_slopes(compliance, face)
    return 0.0, 0.0


@kernel
def _push_of_slopes(compliance, face):
    lever, relief, half = (
        compliance.workspace.lever[face],
        compliance.relief[face],
        compliance.half[face],
    )
    count, along, across = compliance.node.size, 0.0, 0.0
    stiffness = compliance.interface_stiffness * 4.0 * half[0] * abs(half[1]) / (count * count)
    for row in range(count):
        xi = compliance.node[row]
        share = cover(compliance, half[0], lever[MIDDLE], row)[0]
        if share > 0.0:
            fill_row(compliance, face, xi, compliance.workspace.displacement[face])
            x, f0, f1, f2 = _place(compliance, face, xi), 0.0, 0.0, 0.0
            for column in range(count):
                eta = compliance.node[column] + lever[ASIDE]
                p = max(
                    0.0,
                    along_row(compliance.workspace, eta)
                    - relief * (compliance.crown[row] + compliance.crown[column]),
                )
                f0, f1, f2 = f0 + p, f1 + p * eta, f2 + p * eta * eta
            ahead = drawn_walls.slope(compliance.drawn, face, x)
            aside = drawn_walls.height(compliance.drawn, face, x)
            along += stiffness * share * (ahead[0] * f0 + ahead[1] * f1 + ahead[2] * f2)
            across += stiffness * share * (aside[1] * f0 + 2.0 * aside[2] * f1)
    return along, across


@kernel
def drawn_slope(compliance, face, xi, eta):
    """Slope along the rail of the wall as drawn under a point of the face; zero if all walls are
    straight."""
    ahead = drawn_walls.slope(compliance.drawn, face, _place(compliance, face, xi))
    aside = eta + compliance.workspace.lever[face, ASIDE]
    return ahead[0] + aside * (ahead[1] + aside * ahead[2])
