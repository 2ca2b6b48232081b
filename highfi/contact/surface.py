"""Gauss points of the rail walls, and for each pad face the facets it can touch."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tipoff.highfi.mesh import facets as geometry
from tipoff.highfi.state.records import Groups, Surface

_FACING = -0.9  # cosine between pad normal and facet normal below which the two can touch
_MARGIN = 2e-3  # m, how far sideways and in depth a facet may lie from the face's own place


def build(
    surfaces: dict[str, np.ndarray],
    points: np.ndarray,
    faces,
    quadrature: int,
    clamped: np.ndarray,
    thickness: float,
) -> Surface:
    """Surface record of all facets (m,k) in ``surfaces`` whose name starts with ``contact``.

    ``points`` (n,3) m are in frame axes, ``faces`` the model's pad faces, ``clamped`` (k,) numbers
    of nodes, ``thickness`` (m) that of the walls.
    """
    facets = np.concatenate(
        [group for name, group in sorted(surfaces.items()) if name.startswith("contact")]
    )
    nodes = points[facets]
    shape, area = geometry.gauss(nodes, quadrature)
    found = [in_reach(nodes, faces, face) for face in range(faces.axis.size)]
    extent = geometry.hull(nodes)[:, :, 0]
    smallest = extent.min(axis=1)
    found = [group[np.argsort(smallest[group], kind="stable")] for group in found]
    reach = np.concatenate(found)
    longest = float((extent.max(axis=1) - smallest).max())
    first = np.cumsum([0] + [group.size for group in found])
    groups = group_faces(
        [np.unique(facets[group]) for group in found],
        [group.size * len(shape) for group in found],
        clamped,
    )
    return Surface(
        places=points,
        facets=facets,
        shape=shape,
        spread=_spread(shape),
        area=area,
        first=first,
        reach=reach,
        start=smallest[reach],
        longest=longest,
        control=geometry.control(facets.shape[1]),
        groups=groups,
        border=_border(np.einsum("qk,mki->mqi", shape, nodes), found, faces),
        thickness=thickness,
    )


def _border(points: np.ndarray, found: list[np.ndarray], faces) -> np.ndarray:
    """Smallest and largest X and place across the rail (f,4) of the Gauss ``points`` (m,q,3) m of
    the facets ``found`` for each face; from infinity to minus infinity without facets."""
    border = np.tile([np.inf, -np.inf], (len(found), 2))
    for row, group, axis in zip(border, found, faces.axis):
        if group.size:
            along, across = points[group][..., 0], points[group][..., 3 - axis]
            row[:] = along.min(), along.max(), across.min(), across.max()
    return border


def group_faces(nodes: list[np.ndarray], points: list[int], clamped: np.ndarray) -> Groups:
    """Groups of faces, from the ``nodes`` that each face can touch and the number of Gauss
    ``points`` within its reach."""
    face = np.repeat(np.arange(len(nodes)), [part.size for part in nodes])
    node = np.concatenate(nodes)
    size = len(nodes) + node.max(initial=0) + 1
    pairs = coo_array(
        (np.ones(face.size, dtype=bool), (face, len(nodes) + node)), shape=(size, size)
    )
    group = connected_components(pairs, directed=False)[1][: len(nodes)]
    members = [np.flatnonzero(group == name) for name in dict.fromkeys(group.tolist())]
    own = [np.unique(np.concatenate([nodes[each] for each in faces])) for faces in members]
    held = [np.intersect1d(part, clamped) for part in own]
    return Groups(
        face=np.concatenate(members),
        first_face=_starts(members),
        clamped=np.concatenate(held),
        first_clamped=_starts(held),
        first_node=_starts(own)[:-1],
        first_point=np.cumsum([0, *(sum(points[each] for each in faces) for faces in members)])[
            :-1
        ],
    )


def _starts(parts: list[np.ndarray]) -> np.ndarray:
    """First index of each part, and the end of the last, once they are put together."""
    return np.cumsum([0, *(part.size for part in parts)])


def capacity(surface: Surface) -> int:
    """Most contact points that can carry load at once."""
    return surface.reach.size * surface.shape.shape[0]


def magnification(surface: Surface) -> float:
    """How much faster than its fastest node a Gauss point can move: 1 where no shape function is
    negative, else up to 5/3."""
    return float(np.abs(surface.shape).sum(axis=1).max()) if (surface.shape < 0.0).any() else 1.0


def in_reach(nodes: np.ndarray, faces, face: int) -> np.ndarray:
    """Numbers of the facets (nodes (m,k,3) m, axes of ``faces.wall``) that face ``face`` and lie
    beside the track of its pad."""
    axis, sign = faces.axis[face], faces.sign[face]
    across = 3 - axis
    facing = sign * geometry.normals(nodes)[:, axis] < _FACING
    depth = np.abs(nodes[:, :, axis].mean(axis=1) - faces.wall[face]) < _MARGIN
    place, half = faces.centre[face, across], faces.half_width[face] + _MARGIN
    beside = (nodes[:, :, across].max(axis=1) > place - half) & (
        nodes[:, :, across].min(axis=1) < place + half
    )
    return np.flatnonzero(facing & depth & beside)


def _spread(shape: np.ndarray) -> np.ndarray:
    """|N_a| sum over b of |N_b| (q,k), see ``step_limit``; the shape functions themselves where none is
    negative."""
    return (
        np.abs(shape) * np.abs(shape).sum(axis=1, keepdims=True) if (shape < 0.0).any() else shape
    )
