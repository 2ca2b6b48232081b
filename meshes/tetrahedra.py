"""Quadratic tetrahedra of a solid in gmsh, and hexahedra made of them.

Tetrahedra between other planes than those of a grid are of mixed quality, and the worst one sets
the time step of all. So several meshes are made, with and without Netgen's optimisation, with and
without smaller elements at curved faces. The first good one is taken, or else the best one. Edges
that follow a curved face may fold the elements behind them. High-order optimisation moves their
nodes; elements that it cannot unfold get straight edges.
"""

from collections.abc import Callable
from itertools import combinations
from typing import NamedTuple

import numpy as np

_VTK = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]  # place of each node of VTK in gmsh's quadratic tetrahedron
_EDGES = {
    frozenset(edge): node
    for node, edge in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)), start=4)
}
_FACES = list(combinations(range(4), 3))
_POOR = 0.7  # quality below which gmsh optimises an element
_PER_TURN = 8  # edges of elements around a cylinder
_STRAIGHT = 0.05  # scaled Jacobian below which the edges of an element become straight
_PASSES = 20
# Corners of the reference tetrahedron, and the three neighbours of each in right-handed order.
_AROUND = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))

# (points, cells) -> number of steps over that of good hexahedra of this size
Cost = Callable[[np.ndarray, np.ndarray], float]


class Way(NamedTuple):
    """One way to fill a solid."""

    per_turn: int  # elements per full turn of a curved face; 0: no smaller elements
    optimisers: tuple[str, ...]  # of gmsh, one after the other; the default one has no name


_NETGEN, _BOTH = ("Netgen",), ("Netgen", "", "Netgen")
_WAYS = (
    Way(_PER_TURN, ()),
    Way(_PER_TURN, _NETGEN),
    Way(_PER_TURN, _BOTH),
    Way(0, _BOTH),
    Way(0, ()),
)


def filled(
    gmsh, element_size: float, hexahedra: bool, cost: Cost, enough: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points (n,3) m and tetrahedra (e,10), VTK order, with nodes about ``element_size`` (m) apart,
    or hexahedra (4e,8): the first mesh whose ``cost`` is at most ``enough``, else the one with the
    lowest."""
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5 * element_size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 2.0 * element_size)
    gmsh.option.setNumber("Mesh.OptimizeThreshold", _POOR)
    best, lowest = None, np.inf
    curved = any(gmsh.model.getType(2, face) != "Plane" for _, face in gmsh.model.getEntities(2))
    for way in (way for way in _WAYS if way.per_turn or curved):
        points, cells = _straightened(*_made(gmsh, way))
        if hexahedra:
            points, cells = as_hexahedra(points, cells)
        found = cost(points, cells)
        if best is None or found < lowest:
            best, lowest = (points, cells), found
        if lowest <= enough:
            break
    assert best is not None
    return best


def _made(gmsh, way: Way) -> tuple[np.ndarray, np.ndarray]:
    gmsh.model.mesh.clear()
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", way.per_turn)
    gmsh.model.mesh.generate(3)
    for method in way.optimisers:
        gmsh.model.mesh.optimize(method)
    gmsh.model.mesh.setOrder(2)
    gmsh.model.mesh.optimize("HighOrderElastic")
    tags, places, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    kind = gmsh.model.mesh.getElementType("Tetrahedron", 2)
    nodes = gmsh.model.mesh.getElementsByType(kind)[1].astype(np.int64)
    return _compact(places.reshape(-1, 3), number[nodes].reshape(-1, 10)[:, _VTK])


def _straightened(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same mesh with straight edges on all elements that curved edges fold, or almost fold,
    after the split into hexahedra."""
    points = points.copy()
    for _ in range(_PASSES):
        folded = split_quality(points, cells) < _STRAIGHT
        bent = np.zeros(len(cells), dtype=bool)
        for edge, node in _EDGES.items():
            start, end = sorted(edge)
            middle = 0.5 * (points[cells[:, start]] + points[cells[:, end]])
            bent |= (points[cells[:, node]] != middle).any(axis=1)
            points[cells[folded, node]] = middle[folded]
        if not (folded & bent).any():
            break
    return points, cells


def split_quality(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Smallest scaled Jacobian (e,) at the corners of the four hexahedra in each of the tetrahedra
    (e,10)."""
    places, hexes = _split(points, cells)
    corners = places[hexes]
    neighbours = np.array(
        [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
    )
    edges = corners[:, neighbours] - corners[:, :, None]
    scaled = np.linalg.det(edges) / np.linalg.norm(edges, axis=-1).prod(axis=-1)
    return scaled.min(axis=1).reshape(4, -1).min(axis=0)


def as_hexahedra(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (m,3) m and hexahedra (4e,8), VTK order, of tetrahedra (e,10): one at each corner of
    each, between the middles of its edges, its faces and itself; curved edges stay on their
    faces."""
    places, hexes = _split(points, cells)
    return _compact(places, hexes.reshape(4, -1, 8).swapaxes(0, 1).reshape(-1, 8))


def _split(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points and hexahedra (4e,8), those at the first corners first."""
    nodes = points[cells]
    corners = np.concatenate([cells[:, face] for face in _FACES])
    _, first, number = np.unique(
        np.sort(corners, axis=1), axis=0, return_index=True, return_inverse=True
    )
    # Middles by the quadratic shape functions: -1/9 and 4/9 in a face, -1/8 and 1/4 in the solid.
    face_middles = np.concatenate(
        [
            (
                4.0 * nodes[:, [_EDGES[frozenset(edge)] for edge in combinations(face, 2)]]
                - nodes[:, list(face)]
            ).sum(axis=1)
            / 9.0
            for face in _FACES
        ]
    )
    middles = (2.0 * nodes[:, 4:].sum(axis=1) - nodes[:, :4].sum(axis=1)) / 8.0
    of_face = len(points) + number.reshape(len(_FACES), -1)
    own = len(points) + len(first) + np.arange(len(cells))

    def edge(*ends: int) -> np.ndarray:
        return cells[:, _EDGES[frozenset(ends)]]

    def face(*ends: int) -> np.ndarray:
        return of_face[[set(each) for each in _FACES].index(set(ends))]

    hexes = [
        np.stack(
            [
                cells[:, a],
                edge(a, b),
                face(a, b, c),
                edge(a, c),
                edge(a, d),
                face(a, b, d),
                own,
                face(a, c, d),
            ],
            axis=1,
        )
        for a, (b, c, d) in enumerate(_AROUND)
    ]
    return np.concatenate([points, face_middles[first], middles]), np.concatenate(hexes)


def _compact(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points and elements without unused points."""
    used, number = np.unique(cells, return_inverse=True)
    return points[used], number.reshape(cells.shape)
