"""Displacement gradients at the nodes of ten-node tetrahedra, and their peaks (``stress.peak``), in
one pass.

Slopes along the local coordinates are linear in an element, so at the middle of an edge they are
the mean of those at its ends (``elements.tetrahedron``). The slopes of the element's class at each
node convert them to gradients, also between curved edges.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.elements import tetrahedral_recovery
from tipoff.highfi.stress.peak import measure, note
from tipoff.kernels.jit import entry, inlined, kernel
from tipoff.kernels.memory import aligned

NODES = 10
# cost of a scan of an element in steps, at most: 90 ns against 95 with few classes, 870 with one
# class for each element
STEPS = 1.0
_BATCH = 2048  # classes at once; bounds the memory of an unstructured mesh
# Places in the workspace of one element; one flat array, so that the compiler sees that they do not
# overlap.
ALONG, GRADIENT, SQUARES, SIZE = 0, 96, 192, 224


class Recovery(NamedTuple):
    """Elements in c shape classes, and the matrices for gradients of their displacement."""

    cells: np.ndarray  # (e,10) numbers in the nodal arrays
    shape_class: np.ndarray  # (e,)
    slope: np.ndarray  # (c,3*3*10) 1/m, of local coordinate i along j at each node


def build(
    points: np.ndarray,
    cells: np.ndarray,
    shape_class: np.ndarray,
    law: np.ndarray,
    number: np.ndarray,
) -> Recovery:
    """Recovery of a mesh, points (n,3) m and cells (e,10), with the classes of its operator;
    ``number`` (n,) of each node in the nodal arrays. ``law`` is not used."""
    _, representatives = np.unique(shape_class, return_index=True)
    nodes = points[cells[representatives]]
    parts = [
        tetrahedral_recovery.node_slopes(nodes[start : start + _BATCH])
        for start in range(0, len(nodes), _BATCH)
    ]
    slope = np.moveaxis(np.concatenate(parts), 1, 3).reshape(-1, 9 * NODES)
    return Recovery(number[cells].astype(np.uint32), shape_class, aligned(slope))


@entry
def find(displacement, recovery, peak, space, first, last):
    """Raise ``peak`` to the values of elements ``first`` to ``last`` under displacement (n,3) m;
    ``space`` (SIZE,) is workspace."""
    u = displacement.T
    for e in range(first, last):
        _gradients(u, recovery, space, e)
        if measure(space, peak.square, GRADIENT, SQUARES, NODES) > 0:
            note(space, peak, e, SQUARES, NODES)


@kernel
def gradients(displacement, recovery, space, first, last, out):
    """Fill ``out`` (last - first, 90) with displacement gradients of elements ``first`` to
    ``last``: component, axis, node."""
    u = displacement.T
    for e in range(first, last):
        _gradients(u, recovery, space, e)
        for j in range(9 * NODES):
            out[e - first, j] = space[GRADIENT + j]


@inlined
def _gradients(u, recovery, space, e):
    """GRADIENT: displacement gradient at each node of element ``e``."""
    slope = recovery.slope[recovery.shape_class[e]]
    for i in range(3):
        _gather(u[i], recovery.cells[e], space)
        for j in range(3):
            for k in range(NODES):
                space[GRADIENT + NODES * (3 * i + j) + k] = (
                    space[ALONG + k] * slope[NODES * j + k]
                    + space[ALONG + NODES + k] * slope[NODES * (3 + j) + k]
                    + space[ALONG + 2 * NODES + k] * slope[NODES * (6 + j) + k]
                )


@inlined
def _gather(u, nodes, space):
    """ALONG: slopes of one component along each local coordinate, at each node; from its values
    relative to the first node, so that a rigid translation gives exactly zero."""
    first = u[nodes[0]]
    b, c, d = u[nodes[1]] - first, u[nodes[2]] - first, u[nodes[3]] - first
    e, f, g = 4.0 * (u[nodes[4]] - first), 4.0 * (u[nodes[5]] - first), 4.0 * (u[nodes[6]] - first)
    h, i, j = 4.0 * (u[nodes[7]] - first), 4.0 * (u[nodes[8]] - first), 4.0 * (u[nodes[9]] - first)
    _row(space, ALONG, e - b, 3.0 * b - e, (f - g) - b, (i - h) - b)
    _row(space, ALONG + NODES, g - c, (f - e) - c, 3.0 * c - g, (j - h) - c)
    _row(space, ALONG + 2 * NODES, h - d, (i - e) - d, (j - g) - d, 3.0 * d - h)


@inlined
def _row(space, n, a, b, c, d):
    """One linear function at the corners and at the middles of the edges."""
    space[n], space[n + 1], space[n + 2], space[n + 3] = a, b, c, d
    space[n + 4], space[n + 5], space[n + 6] = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (a + c)
    space[n + 7], space[n + 8], space[n + 9] = 0.5 * (a + d), 0.5 * (b + d), 0.5 * (c + d)
