"""Meshes of ten-node tetrahedra made from those of hexahedra, each split into six around its
diagonal."""

import numpy as np

from tipoff.highfi.elements.tetrahedron import EDGES
from tipoff.highfi.mesh.cells import TETRAHEDRON
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets

# Tetrahedra around the diagonal from corner 0 to corner 6, one for each way along the three axes
# (Kuhn). Neighbours whose corners are numbered along the same axes meet in the same triangles.
_AROUND = np.array(
    [[0, 1, 2, 6], [0, 5, 1, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 4, 5, 6], [0, 7, 4, 6]]
)


def quadratic(points, corners):
    """Points (n,3) with the middle of every edge of tetrahedra (e,4), and the tetrahedra (e,10)."""
    pairs = np.sort(corners[:, EDGES].reshape(-1, 2), axis=1)
    edges, number = np.unique(pairs, axis=0, return_inverse=True)
    middles = points[edges].mean(axis=1)
    return np.concatenate([points, middles]), np.concatenate(
        [corners, len(points) + number.reshape(-1, 6)], axis=1
    )


def split(mesh) -> RailMesh:
    """The hexahedra of `mesh` as six tetrahedra each, with the same surfaces."""
    points, cells = quadratic(mesh.points, mesh.cells[:, _AROUND].reshape(-1, 4))
    return RailMesh(
        points, cells, {name: facets_of(cells, quads) for name, quads in mesh.surfaces.items()}
    )


def facets_of(cells, quads):
    """The two triangles (m,6) on the boundary of tetrahedra that each of the quadrilaterals (m,4)
    consists of."""
    facets = boundary_facets(cells)
    three = {
        tuple(sorted(np.delete(quad, corner).tolist())) for quad in quads for corner in range(4)
    }
    return facets[[tuple(sorted(facet[:3].tolist())) in three for facet in facets]]


def bent(mesh, place) -> RailMesh:
    """`mesh` with every point moved by `place`, so that edges are curved."""
    return RailMesh(place(mesh.points), mesh.cells, mesh.surfaces)


def face_vectors(points, cells):
    """Area vectors (e,4,3) in m2 of the faces, by their corners."""
    corners = points[cells[:, TETRAHEDRON.faces[:, :3]]]
    return 0.5 * np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
