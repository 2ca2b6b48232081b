"""The deformed wall at a point: its facet, its height and slope, and the share of a cell that lies
over it.

The wall is seen along its nominal normal, the axis ``a`` of the frame. At a place (X, Y) of its plane

    w = sum over nodes of N_a (x_a + u_a),      dw/dX, dw/dY

with the coordinates x_a + u_a along the normal, and the nodal functions N_a of the facet that lies
there without load. Displacement in the plane, about 1e-5 m, also changes the material point at the
place; this effect is of second order in a linear rail and left out. So w is linear in u, and a
force on the wall is distributed exactly by the N_a.

A facet maps (X, Y) to its own coordinates (r, s) with q = A [(X, Y) - o] and (r, s) = q - b r s: o, A
and b are a row of ``Surface.map``. They run from -1 to 1 over four corners, where b is zero for a
parallelogram. Over six nodes they are the barycentric coordinates of the second and third corner, and
edges are taken as straight.
"""

import numpy as np

from tipoff.kernels.jit import inlined

INSIDE = 1e-9  # in (r, s): a place with a smaller excess is inside the facet
_GAP = 1e-6  # in (r, s): far from the border, a smaller gap between facets is rounding
_TWISTED = 8  # iterations for b; each reduces the error by a factor of about b


@inlined
def bin_under(search, wall, x, y):
    """Number of the bin at a place (m) of a wall; -1 outside."""
    along = (x - search.low[wall, 0]) * search.per_length[wall, 0]
    across = (y - search.low[wall, 1]) * search.per_length[wall, 1]
    found = -1
    if 0.0 <= along < search.bins[wall, 0] and 0.0 <= across < search.bins[wall, 1]:
        found = search.first_bin[wall] + int(along) * search.bins[wall, 1] + int(across)
    return found


@inlined
def facet_under(surface, cell_bin, x, y):
    """Facet at a place (m) over a bin, (r, s) there, and the excess in (r, s) outside the facet.
    Without a facet there, it is the nearest one of the bin; -1 if the bin has none."""
    search = surface.search
    found, best, first, second = -1, np.inf, 0.0, 0.0
    for k in range(search.first_facet[cell_bin], search.first_facet[cell_bin + 1]):
        facet = search.facet[k]
        r, s, outside = local(surface, facet, x, y)
        if outside < best:
            found, best, first, second = facet, outside, r, s
            if outside <= INSIDE:
                break
    return found, first, second, best


@inlined
def local(surface, facet, x, y):
    """(r, s) of a place (m) on a facet, and the excess in (r, s) outside it."""
    r, s = _mapped(surface.quadratic, surface.map[facet], x, y)
    return r, s, _outside(surface.quadratic, r, s)


@inlined
def _mapped(quadratic, row, x, y):
    dx, dy = x - row[0], y - row[1]
    first, second = row[2] * dx + row[3] * dy, row[4] * dx + row[5] * dy
    r, s = first, second
    if quadratic is None:
        if row[6] != 0.0 or row[7] != 0.0:
            for _ in range(_TWISTED):
                r, s = first - row[6] * r * s, second - row[7] * r * s
    return r, s


@inlined
def _outside(quadratic, r, s):
    outside = max(abs(r), abs(s)) - 1.0
    if quadratic is not None:
        outside = max(-r, -s, r + s - 1.0)
    return outside


@inlined
def functions(quadratic, r, s):
    """Nodal functions at (r, s), the last two zero for four corners."""
    t = 1.0 - r - s
    found = (
        t * (2.0 * t - 1.0),
        r * (2.0 * r - 1.0),
        s * (2.0 * s - 1.0),
        4.0 * t * r,
        4.0 * r * s,
        4.0 * s * t,
    )
    if quadratic is None:
        a, b, c, d = 0.5 * (1.0 - r), 0.5 * (1.0 + r), 0.5 * (1.0 - s), 0.5 * (1.0 + s)
        found = (a * c, b * c, b * d, a * d, 0.0, 0.0)
    return found


@inlined
def nodes_of(surface, facet):
    """Numbers of the six nodes of a facet; the last two have no meaning if it has four.

    Unsigned, because a signed index needs a test for negative values.
    """
    facets = surface.facets
    fifth, sixth = np.uint64(0), np.uint64(0)
    if surface.quadratic is not None:
        fifth, sixth = np.uint64(facets[facet, 4]), np.uint64(facets[facet, 5])
    return (
        np.uint64(facets[facet, 0]),
        np.uint64(facets[facet, 1]),
        np.uint64(facets[facet, 2]),
        np.uint64(facets[facet, 3]),
        fifth,
        sixth,
    )


@inlined
def heights(surface, displacement, axis, nodes):
    """Coordinates (m) of the six nodes of a facet along ``axis``; zeros after the fourth if it has
    four."""
    places = surface.places
    fifth, sixth = 0.0, 0.0
    if surface.quadratic is not None:
        fifth = places[nodes[4], axis] + displacement[nodes[4], axis]
        sixth = places[nodes[5], axis] + displacement[nodes[5], axis]
    return (
        places[nodes[0], axis] + displacement[nodes[0], axis],
        places[nodes[1], axis] + displacement[nodes[1], axis],
        places[nodes[2], axis] + displacement[nodes[2], axis],
        places[nodes[3], axis] + displacement[nodes[3], axis],
        fifth,
        sixth,
    )


@inlined
def extremes(quadratic, height, sign):
    """Bounds of ``sign`` times the height over a facet: from its four nodes, or from the six
    control points of the quadratic (Farin, Curves and Surfaces for CAGD, chapter 17)."""
    a, b, c, d = sign * height[0], sign * height[1], sign * height[2], sign * height[3]
    low, high = min(min(a, b), min(c, d)), max(max(a, b), max(c, d))
    if quadratic is not None:
        p = 2.0 * d - 0.5 * (a + b)
        q = 2.0 * sign * height[4] - 0.5 * (b + c)
        r = 2.0 * sign * height[5] - 0.5 * (c + a)
        low, high = min(min(a, b), min(c, p), min(q, r)), max(max(a, b), max(c, p), max(q, r))
    return low, high


@inlined
def blend(weight, value):
    """Weighted sum of the values of six nodes."""
    return (
        weight[0] * value[0]
        + weight[1] * value[1]
        + weight[2] * value[2]
        + weight[3] * value[3]
        + weight[4] * value[4]
        + weight[5] * value[5]
    )


@inlined
def slopes(surface, facet, r, s, height):
    """Slopes dw/dX and dw/dY at (r, s) of the facet whose nodes have these heights (m)."""
    by_r, by_s = _derivatives(surface.quadratic, r, s, height)
    row = surface.map[facet]
    if surface.quadratic is None:
        # d(q)/d(r, s) = 1 + b (s, r)
        m00, m01 = 1.0 + row[6] * s, row[6] * r
        m10, m11 = row[7] * s, 1.0 + row[7] * r
        scale = 1.0 / (m00 * m11 - m01 * m10)
        by_r, by_s = scale * (m11 * by_r - m10 * by_s), scale * (m00 * by_s - m01 * by_r)
    return row[2] * by_r + row[4] * by_s, row[3] * by_r + row[5] * by_s


@inlined
def _derivatives(quadratic, r, s, h):
    t = 1.0 - r - s
    by_r = (
        (1.0 - 4.0 * t) * h[0]
        + (4.0 * r - 1.0) * h[1]
        + 4.0 * ((t - r) * h[3] + s * h[4] - s * h[5])
    )
    by_s = (
        (1.0 - 4.0 * t) * h[0]
        + (4.0 * s - 1.0) * h[2]
        + 4.0 * (r * h[4] - r * h[3] + (t - s) * h[5])
    )
    if quadratic is None:
        by_r = 0.25 * ((1.0 - s) * (h[1] - h[0]) + (1.0 + s) * (h[2] - h[3]))
        by_s = 0.25 * ((1.0 - r) * (h[3] - h[0]) + (1.0 + r) * (h[2] - h[1]))
    return by_r, by_s


@inlined
def cover(search, cell_bin, x, y, size, outside):
    """Share over the wall of a cell of ``size`` (m along X, m across) with its middle at a place
    (m), and the slopes of the share (1/m). ``outside``: of the place, see ``facet_under``.

    The share is one half plus the distance from the border in cells. So it is continuous, and exact
    for a straight border parallel to an edge of the cell. At a corner of the wall its error is up
    to one fifth.
    """
    least, by_x, by_y = np.inf, 0.0, 0.0
    for k in range(search.first_edge[cell_bin], search.first_edge[cell_bin + 1]):
        distance, slope_x, slope_y = _distance(search.ends[search.edge[k]], x, y, size)
        if distance < least:
            least, by_x, by_y = distance, slope_x, slope_y
    sign = 1.0 if outside <= INSIDE else -1.0
    if least == np.inf and outside < _GAP:
        sign = 1.0
    share = 0.5 + sign * least
    if share >= 1.0 or share <= 0.0:
        share, by_x, by_y = min(1.0, max(0.0, share)), 0.0, 0.0
    return share, sign * by_x, sign * by_y


@inlined
def _distance(end, x, y, size):
    """Distance in cells of a place from a piece of the border, and its slopes (1/m)."""
    along_x, along_y = (end[2] - end[0]) / size[0], (end[3] - end[1]) / size[1]
    dx, dy = (x - end[0]) / size[0], (y - end[1]) / size[1]
    way = (dx * along_x + dy * along_y) / (along_x * along_x + along_y * along_y)
    way = min(1.0, max(0.0, way))
    dx, dy = dx - way * along_x, dy - way * along_y
    distance = np.sqrt(dx * dx + dy * dy)
    scale = 1.0 / distance if distance > 0.0 else 0.0
    return distance, scale * dx / size[0], scale * dy / size[1]
