"""Uniform refinement of a mesh from a file.

Tetrahedra are halved (``mesh.halve``) repeatedly. Each hexahedron becomes n x n x n of them at equal
distances of its own coordinates: points lie at the trilinear map of the corners, and curved walls
keep the facets of the file. A point is identified by its integer weights on the corners (in units of
1/n^3). They are the same in every element that shares it, so neighbours are joined without comparing
places.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from tipoff.highfi.mesh.cells import HEXAHEDRON, edge_lengths, kind
from tipoff.highfi.mesh.halve import Points, halved, halved_with_weights, interpolation
from tipoff.highfi.mesh.rail_mesh import RailMesh

# Corners of the unit square and cube in VTK order.
_SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
_CUBE = np.concatenate([np.insert(_SQUARE, 2, level, axis=1) for level in (0, 1)])


def to_size(mesh: RailMesh, element_size: float) -> RailMesh:
    """``mesh`` split so that its shortest edges, as a rule across a wall, come near to
    ``element_size`` (m); never coarser."""
    count = parts(mesh, element_size)
    if kind(mesh.cells) is HEXAHEDRON:
        return split(mesh, count)
    for _ in range(round(math.log2(count))):
        mesh = halved(mesh)
    return mesh


def parts(mesh: RailMesh, element_size: float) -> int:
    """Elements that ``to_size`` makes along every edge of each one: a power of two for
    tetrahedra."""
    ratio = shortest(mesh) / element_size
    if kind(mesh.cells) is HEXAHEDRON:
        return max(1, round(ratio))
    return 2 ** max(0, round(math.log2(ratio)))


def shortest(mesh: RailMesh) -> float:
    """Median of the shortest edge (m) of each element."""
    return float(np.median(edge_lengths(mesh.points, mesh.cells).min(axis=1)))


def split(mesh: RailMesh, parts: int) -> RailMesh:
    """Hexahedra with ``parts`` elements along every edge of each in ``mesh``; warnings stay:
    they give the elements of the file."""
    return mesh if parts == 1 else _split(mesh, parts)[0]


def refined(mesh: RailMesh) -> tuple[RailMesh, csr_array]:
    """``mesh`` with two elements along every edge of each, and the matrix (n,m) that interpolates
    values at its m nodes to the n nodes of the result."""
    if kind(mesh.cells) is HEXAHEDRON:
        return _split(mesh, 2)
    return halved_with_weights(mesh)


def _split(mesh: RailMesh, parts: int) -> tuple[RailMesh, csr_array]:
    # One random number per node makes a sum of weights a name of the point, whichever element it is
    # seen from.
    names = np.random.default_rng(0).integers(1, 2**63, len(mesh.points), dtype=np.uint64)
    cells, weights = _lattice(_CUBE, parts)
    points = Points(names[mesh.cells] @ weights.T)
    places = np.einsum("pc,eci->epi", weights / float(parts**3), mesh.points[mesh.cells]).reshape(
        -1, 3
    )
    hexes = points.number[:, cells].reshape(-1, 8)
    quads, shares = _lattice(_SQUARE, parts)
    surfaces = {
        name: points.named(names[facets] @ (shares * np.uint64(parts)).T)[:, quads].reshape(-1, 4)
        for name, facets in mesh.surfaces.items()
    }
    finer = replace(mesh, points=places[points.first], cells=hexes, surfaces=surfaces)
    return finer, interpolation(mesh, points.first, weights / float(parts**3))


def _lattice(corners: np.ndarray, parts: int) -> tuple[np.ndarray, np.ndarray]:
    """Cells (c,k) of a unit square or cube (k corners) split evenly, and integer weights (p,k) of
    their points on its corners."""
    dimension = corners.shape[1]
    steps = np.stack(
        np.meshgrid(*[np.arange(parts + 1)] * dimension, indexing="ij"), axis=-1
    ).reshape(-1, dimension)
    weights = np.where(corners, steps[:, None], parts - steps[:, None]).prod(axis=2)
    place = (parts + 1) ** np.arange(dimension)[::-1]
    lowest = steps[(steps < parts).all(axis=1)]
    return (lowest[:, None] + corners) @ place, weights.astype(np.uint64)
