"""Separate solids of a mesh. Solids that are mirror images of each other need only one solution."""

from itertools import product

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tipoff.highfi.mesh.rail_mesh import RailMesh


def pieces(mesh: RailMesh) -> list[RailMesh]:
    """Each solid as a mesh of its own, in the order of their first nodes; missing surfaces are
    empty."""
    return [_part(mesh, own) for own in nodes(mesh)]


def nodes(mesh: RailMesh) -> list[np.ndarray]:
    """Numbers of the nodes of each solid, in ascending order."""
    first = np.repeat(mesh.cells[:, 0], mesh.cells.shape[1])
    size = len(mesh.points)
    graph = coo_array(
        (np.ones(first.size, dtype=bool), (first, mesh.cells.ravel())), shape=(size, size)
    )
    count, piece = connected_components(graph, directed=False)
    return [np.flatnonzero(piece == which) for which in range(count)]


def distinct(mesh: RailMesh) -> list[tuple[RailMesh, list[np.ndarray]]]:
    """Solids of which no two are mirror images with the same numbering, each with the signs (3,) of
    its images, its own first."""
    found: list[tuple[RailMesh, list[np.ndarray]]] = []
    for piece in pieces(mesh):
        for first, images in found:
            if (signs := mirror(first, piece)) is not None:
                images.append(signs)
                break
        else:
            found.append((piece, [np.ones(3)]))
    return found


def _part(mesh: RailMesh, own: np.ndarray) -> RailMesh:
    inside = np.zeros(len(mesh.points), dtype=np.bool_)
    inside[own] = True
    number = np.cumsum(inside) - 1
    surfaces = {
        name: number[facets[inside[facets[:, 0]]]] for name, facets in mesh.surfaces.items()
    }
    return RailMesh(mesh.points[inside], number[mesh.cells[inside[mesh.cells[:, 0]]]], surfaces)


def mirror(first: RailMesh, other: RailMesh) -> np.ndarray | None:
    """Signs of y and z that map the points of ``first`` to those of ``other``, bit for bit and in
    the same order; None if there are none."""
    groups = [
        (first.cells, other.cells),
        *((first.surfaces[name], other.surfaces[name]) for name in first.surfaces),
    ]
    # A reflection reverses the order of the nodes of an element.
    if not all(
        np.array_equal(np.sort(ours, axis=1), np.sort(theirs, axis=1)) for ours, theirs in groups
    ):
        return None
    signs = (np.array([1.0, *pair]) for pair in product((1.0, -1.0), repeat=2))
    return next((each for each in signs if np.array_equal(first.points * each, other.points)), None)
