"""Facets of the boundary that lie on each other without shared nodes, for example if two parts of a
rail are meshed separately. Nothing joins them: each part deflects alone, and the parts can pass
through each other.

Two facets touch where their planes coincide, their normals are opposite, and the middle of one lies
within the other.
"""

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.highfi.mesh import facets
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets

_SAME = 1e-6  # m, below the manufacturing tolerance of a rail
_OPPOSITE = -0.999  # cosine between normals
_NEAREST = 16  # facets whose middles are compared with one


def warning(mesh: RailMesh) -> tuple[str, ...]:
    """One sentence with area and place of the facets that touch; none without such facets."""
    found = touching(mesh)
    if not len(found):
        return ()
    points = mesh.points[found].reshape(-1, 3)
    spans = zip("xyz", points.min(axis=0), points.max(axis=0))
    place = ", ".join(f"{axis} {low:.6g} to {high:.6g} m" for axis, low, high in spans)
    return (
        f"{len(found)} facets on both sides ({1e6 * facets.area(mesh.points, found):,.4g} mm2) touch others "
        f"without shared nodes, {place}: nothing joins the two sides, and they can pass through each "
        "other; merge the nodes in the mesh generator if the rail is one piece there",
    )


def touching(mesh: RailMesh) -> np.ndarray:
    """Facets (m,f) of the boundary that touch another one from the other side."""
    every = boundary_facets(mesh.cells)
    corners = mesh.points[every][:, : 4 if every.shape[1] == 4 else 3]
    middles, normals = corners.mean(axis=1), facets.normals(mesh.points[every])
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    tree = scipy.spatial.cKDTree(middles)
    near = min(_NEAREST, len(every))
    _, other = tree.query(middles, near, distance_upper_bound=reach.max(initial=0.0) + _SAME)
    one, column = np.nonzero(other < len(every))
    # Each pair in both directions: the sixteen nearest facets of a small one may not include a
    # large one.
    one, two = np.concatenate([one, other[one, column]]), np.concatenate([other[one, column], one])
    away = middles[one] - middles[two]
    close = (
        (one != two)
        & (np.abs(np.einsum("pi,pi->p", away, normals[two])) < _SAME)
        & (np.einsum("pi,pi->p", normals[one], normals[two]) < _OPPOSITE)
    )
    one, two = one[close], two[close]
    # inside all edges of the other facet, seen along its normal
    start = corners[two]
    edges = np.roll(start, -1, axis=1) - start
    inward = np.cross(normals[two][:, None], edges)
    depth = np.einsum("pki,pki->pk", middles[one][:, None] - start, inward)
    inside = (depth > -_SAME * np.linalg.norm(inward, axis=2)).all(axis=1)
    chosen = np.unique(np.concatenate([one[inside], two[inside]]))
    return every[chosen]
