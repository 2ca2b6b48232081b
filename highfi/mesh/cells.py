"""Numbering and quality of the two kinds of element: 8-node hexahedra and 10-node tetrahedra.

A hexahedron is checked at its corners, where J = e1 . (e2 x e3) with e the three edges that leave a
corner. In a tetrahedron det J is a cubic polynomial, which lies between the smallest and the
largest of its 20 Bernstein coefficients. If all of them are positive, it is positive everywhere,
also between curved edges. Both orders of nodes are those of VTK and meshio.
"""

from itertools import product
from math import factorial
from typing import NamedTuple

import numpy as np

from tipoff.highfi.elements import tetrahedron


class Kind(NamedTuple):
    """A kind of element."""

    name: str  # in messages
    facets: str  # name of its faces in messages
    cell: str  # name in meshio
    facet: str  # name of its faces in meshio
    # (f,k) nodes of each face, corners first, counter-clockwise seen from outside
    faces: np.ndarray
    edges: np.ndarray  # (b,2) corners
    thickness: str  # name of the length that limits the step


HEXAHEDRON = Kind(
    name="8-node hexahedra",
    facets="quadrilateral",
    cell="hexahedron",
    facet="quad",
    faces=np.array(
        [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]
    ),
    edges=np.array(
        [
            [0, 1],
            [1, 2],
            [2, 3],
            [3, 0],
            [4, 5],
            [5, 6],
            [6, 7],
            [7, 4],
            [0, 4],
            [1, 5],
            [2, 6],
            [3, 7],
        ]
    ),
    thickness="edge",
)
TETRAHEDRON = Kind(
    name="10-node tetrahedra",
    facets="triangle",
    cell="tetra10",
    facet="triangle6",
    faces=np.array(
        [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]]
    ),
    edges=tetrahedron.EDGES,
    thickness="altitude",
)
KINDS = {8: HEXAHEDRON, 10: TETRAHEDRON}

# The three neighbours of each corner of a hexahedron, ordered so that their triple product is
# positive.
_NEIGHBOURS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
# Powers of the barycentric coordinates in the 20 Bernstein polynomials of degree three, and places
# for their interpolation.
_POWERS = np.array([powers for powers in product(range(4), repeat=4) if sum(powers) == 3])
_LATTICE = _POWERS / 3.0


def kind(cells: np.ndarray) -> Kind:
    """Kind of the elements (e,k)."""
    return KINDS[cells.shape[1]]


def jacobians(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients (e,j) in m3 that bound the Jacobian of each element, and the same scaled: 1 for
    a brick and for a regular tetrahedron."""
    return (
        corner_jacobians(points, cells)
        if kind(cells) is HEXAHEDRON
        else _control_jacobians(points[cells])
    )


def corner_jacobians(points: np.ndarray, hexes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Jacobian (e,8) at the corners of hexahedra in m3, and the same scaled by the lengths of the
    three edges (1 for a brick)."""
    corners = points[hexes]
    edges = corners[:, _NEIGHBOURS] - corners[:, :, None]
    jacobian = np.linalg.det(edges)
    lengths = np.linalg.norm(edges, axis=-1).prod(axis=-1)
    return jacobian, np.divide(jacobian, lengths, out=np.zeros_like(jacobian), where=lengths > 0.0)


def edge_lengths(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Lengths (e,b) in m of the edges of each element; of the chords of curved edges."""
    start, end = kind(cells).edges.T
    return np.linalg.norm(points[cells[:, end]] - points[cells[:, start]], axis=-1)


def thickness(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Least thickness (e,) in m of each element, which limits its step: an edge of a hexahedron, an
    altitude of a tetrahedron."""
    if kind(cells) is HEXAHEDRON:
        return edge_lengths(points, cells).min(axis=1)
    corners = points[cells[:, :4]]
    face = corners[:, TETRAHEDRON.faces[:, :3]]
    area = 0.5 * np.linalg.norm(
        np.cross(face[:, :, 1] - face[:, :, 0], face[:, :, 2] - face[:, :, 0]), axis=-1
    )
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6.0
    return np.divide(
        3.0 * volume, area.max(axis=1), out=np.zeros_like(volume), where=area.max(axis=1) > 0.0
    )


def _control_jacobians(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bernstein coefficients (e,20) of det J, and the same over the largest product of three edges
    at a corner, times sqrt(2)."""
    _, gradients = tetrahedron.shape_functions(_LATTICE[:, 1:].T)
    found = np.linalg.det(tetrahedron.jacobians(nodes, gradients))
    weights = [factorial(3) / np.prod([factorial(power) for power in powers]) for powers in _POWERS]
    bernstein = weights * (_LATTICE[:, None] ** _POWERS).prod(axis=2)
    coefficients = np.linalg.solve(bernstein, found.T).T
    corners = nodes[:, :4]
    lengths = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=-1)
    meeting = np.where(np.eye(4, dtype=bool), 1.0, lengths).prod(axis=2).max(axis=1)[:, None]
    return coefficients, np.divide(
        np.sqrt(2.0) * coefficients, meeting, out=np.zeros_like(coefficients), where=meeting > 0.0
    )
