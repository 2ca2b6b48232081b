"""Gauss points of the rail walls, and for each pad face the facets it can meet."""

import numpy as np

from highfi.records import Surface

_FACING = -0.9  # cosine between pad normal and facet normal below which the two can touch
_MARGIN = 2e-3  # m, how far sideways and in depth a facet may lie from the face's own place


def build(surfaces: dict[str, np.ndarray], points: np.ndarray, faces, quadrature: int) -> Surface:
    """Surface record of all facets (m,4) in ``surfaces`` whose name starts with ``contact``.

    ``points`` (n,3) m are in frame axes, ``faces`` the model's pad faces.
    """
    facets = np.concatenate([quads for name, quads in sorted(surfaces.items()) if name.startswith("contact")])
    corners = points[facets]
    shape, area = _gauss(corners, quadrature)
    groups = [in_reach(corners, faces, face) for face in range(faces.axis.size)]
    smallest = corners[:, :, 0].min(axis=1)
    groups = [group[np.argsort(smallest[group], kind="stable")] for group in groups]
    reach = np.concatenate(groups)
    longest = float((corners[:, :, 0].max(axis=1) - smallest).max())
    first = np.cumsum([0] + [group.size for group in groups])
    return Surface(facets, shape, area, first, reach, smallest[reach], longest)


def capacity(surface: Surface) -> int:
    """Most contact points that can carry load at once."""
    return surface.reach.size * surface.shape.shape[0]


def in_reach(corners: np.ndarray, faces, face: int) -> np.ndarray:
    """Numbers of the facets (corners (m,4,3) m, axes of ``faces.wall``) that face ``face`` and lie beside the track of its pad."""
    axis, sign = faces.axis[face], faces.sign[face]
    across = 3 - axis
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    facing = sign * normal[:, axis] / np.linalg.norm(normal, axis=1) < _FACING
    depth = np.abs(corners[:, :, axis].mean(axis=1) - faces.wall[face]) < _MARGIN
    place, half = faces.centre[face, across], faces.half_width[face] + _MARGIN
    beside = ((corners[:, :, across].max(axis=1) > place - half) & (corners[:, :, across].min(axis=1) < place + half))
    return np.flatnonzero(facing & depth & beside)


def _gauss(corners: np.ndarray, quadrature: int) -> tuple[np.ndarray, np.ndarray]:
    """Bilinear shape functions (q,4) and areas (m,q) at the tensor Gauss points of the facets (m,4,3)."""
    nodes, weights = np.polynomial.legendre.leggauss(quadrature)
    r, s = (grid.ravel() for grid in np.meshgrid(nodes, nodes, indexing="ij"))
    weight = np.outer(weights, weights).ravel()
    ra, sa = np.array([-1.0, 1.0, 1.0, -1.0]), np.array([-1.0, -1.0, 1.0, 1.0])
    shape = 0.25 * (1.0 + np.outer(r, ra)) * (1.0 + np.outer(s, sa))
    along_r = np.einsum("qa,mai->mqi", 0.25 * ra * (1.0 + np.outer(s, sa)), corners)
    along_s = np.einsum("qa,mai->mqi", 0.25 * sa * (1.0 + np.outer(r, ra)), corners)
    return shape, np.linalg.norm(np.cross(along_r, along_s), axis=2) * weight
