"""Solid elements of mesh files, and the elements of the solver that they become.

| in a file | here |
|---|---|
| 8-node hexahedron, 10-node tetrahedron | the same |
| 4-node tetrahedron | 10 nodes; the six new ones are the middles of its straight edges |
| 27-node hexahedron | eight 8-node hexahedra between its nodes |
| 20-node hexahedron | the same, with the middles of its faces and its centre at their places |

The middle of a face of a 20-node hexahedron is N = -1/4 at its corners and 1/2 at the middles of its
edges, its centre is N = -1/4 at corners and 1/4 at middles (Zienkiewicz, Taylor and Zhu, The Finite
Element Method, 7th ed. 2013, section 6.3.4). Formats number the middle nodes of hexahedra in different
orders. So each is taken for the edge or face whose middle it is nearest to.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.mesh.cells import HEXAHEDRON, TETRAHEDRON, Kind


class FileElement(NamedTuple):
    """A type of solid element in files."""

    name: str  # in messages
    kind: Kind  # of the elements made of it
    parts: int  # elements made of one


FILE_ELEMENTS = {
    "hexahedron": FileElement("8-node hexahedra", HEXAHEDRON, 1),
    "hexahedron20": FileElement("20-node hexahedra", HEXAHEDRON, 8),
    "hexahedron27": FileElement("27-node hexahedra", HEXAHEDRON, 8),
    "tetra": FileElement("4-node tetrahedra", TETRAHEDRON, 1),
    "tetra10": FileElement("10-node tetrahedra", TETRAHEDRON, 1),
}
_CORNERS = np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
# coordinates of 27 nodes: corners, middles of edges, middles of faces, centre
_LATTICE = np.concatenate(
    [
        _CORNERS,
        *(
            _CORNERS[table].mean(axis=1).astype(int)
            for table in (HEXAHEDRON.edges, HEXAHEDRON.faces)
        ),
        np.zeros((1, 3), dtype=int),
    ]
)
# (8,8) nodes of the part at each corner; it is turned as the whole element is
_PARTS = np.array(
    [
        [_LATTICE.tolist().index(((own + other) // 2).tolist()) for other in _CORNERS]
        for own in _CORNERS
    ]
)


def corners(kind: Kind) -> np.ndarray:
    """Corners (f,4) or (f,3) of each face of an element."""
    return kind.faces[:, : 4 if kind is HEXAHEDRON else 3]


def converted(
    name: str, points: np.ndarray, cells: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points and elements of the solver made of the elements (e,k) of a type, those of one element
    after each other, and the numbers of elements whose middle nodes are not near the middles of
    edges and faces."""
    nothing = np.array([], dtype=np.int64)
    if name == "tetra":
        return *_with_middles(points, cells), nothing
    if FILE_ELEMENTS[name].parts == 1:
        return points, cells, nothing
    targets = points[cells[:, :8]]
    middles, astray = _nearest(points, cells[:, 8:20], targets[:, HEXAHEDRON.edges].mean(axis=2))
    if cells.shape[1] == 27:
        ends = np.concatenate(
            [targets[:, HEXAHEDRON.faces].mean(axis=2), targets.mean(axis=1)[:, None]], axis=1
        )
        inner, wrong = _nearest(points, cells[:, 20:], ends)
        lattice = np.concatenate([cells[:, :8], middles, inner], axis=1)
        astray = np.union1d(astray, wrong)
    else:
        points, lattice = _with_faces(points, np.concatenate([cells[:, :8], middles], axis=1))
    return points, lattice[:, _PARTS].reshape(-1, 8), astray


def facets(name: str, cells: np.ndarray, elements: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Facets (m,4) or (m,6) of the elements of the solver, from the numbers of ``elements`` (f,) of
    the file and of their ``faces`` (f,); one face has four facets where an element has eight
    parts."""
    _, kind, parts = FILE_ELEMENTS[name]
    table = kind.faces[faces]
    if parts == 1:
        return np.take_along_axis(cells[elements], table, axis=1)
    # the parts at the four corners of the face
    rows = cells[parts * elements[:, None] + table]
    return np.take_along_axis(rows, table[:, None], axis=2).reshape(-1, 4)


def _nearest(
    points: np.ndarray, nodes: np.ndarray, targets: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The node (e,t) of each element that is nearest to each of its ``targets`` (e,t,3), and the
    elements in which one node is the nearest to two of them."""
    away = np.stack(
        [
            np.linalg.norm(points[nodes] - targets[:, [place]], axis=2)
            for place in range(nodes.shape[1])
        ],
        axis=1,
    )
    order = np.nan_to_num(away, nan=np.inf).argmin(axis=2)
    twice = (np.sort(order, axis=1) != np.arange(nodes.shape[1])).any(axis=1)
    order[twice] = np.arange(nodes.shape[1])
    return np.take_along_axis(nodes, order, axis=1), np.flatnonzero(twice)


def _with_middles(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    ends = np.sort(cells[:, TETRAHEDRON.edges].reshape(-1, 2), axis=1)
    edges, number = np.unique(ends, axis=0, return_inverse=True)
    middles = len(points) + number.reshape(len(cells), -1)
    points = np.concatenate([points, points[edges].mean(axis=1)])
    return points, np.concatenate([cells, middles], axis=1)


def _with_faces(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points with the middles of the faces and the centres of 20-node hexahedra (e,20), and the
    hexahedra with 27 nodes."""
    around = cells[:, HEXAHEDRON.faces].reshape(-1, 4)
    _, first, number = np.unique(
        np.sort(around, axis=1), axis=0, return_index=True, return_inverse=True
    )
    # the four middles of the edges of each face
    beside = np.array(
        [
            [8 + place for place, edge in enumerate(HEXAHEDRON.edges) if set(edge) <= set(face)]
            for face in HEXAHEDRON.faces.tolist()
        ]
    )
    edges = cells[:, beside].reshape(-1, 4)
    faces = 0.5 * points[edges[first]].sum(axis=1) - 0.25 * points[around[first]].sum(axis=1)
    centres = 0.25 * (points[cells[:, 8:]].sum(axis=1) - points[cells[:, :8]].sum(axis=1))
    numbers = len(points) + np.column_stack(
        [number.reshape(len(cells), 6), len(faces) + np.arange(len(cells))]
    )
    return np.concatenate([points, faces, centres]), np.concatenate([cells, numbers], axis=1)
