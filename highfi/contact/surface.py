"""Facets of the rail walls, the facets that each pad face can touch, and the cells of the faces."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tipoff.highfi.contact import search
from tipoff.highfi.mesh import facets as geometry
from tipoff.highfi.numerics import LEAST_CELLS
from tipoff.highfi.state.records import Groups, Surface

_FACING = -0.9  # cosine between pad normal and facet normal below which the two can touch
_CELLS_PER_FACET = 2  # along each edge of a facet, at least
_GAUSS = 4  # points along each edge of a facet, for integrals of |N_a N_b|
_MARGIN = 2e-3  # m, largest distance of a facet from the face, sideways and in depth


def build(
    surfaces: dict[str, np.ndarray],
    points: np.ndarray,
    faces,
    cells: int | None,
    clamped: np.ndarray,
    thickness: float,
) -> Surface:
    """Surface record of all facets (m,k) in ``surfaces`` whose name starts with ``contact``.

    ``points`` (n,3) m are in frame axes, ``faces`` the model's pad faces, ``cells`` the number along
    each edge of a face (None: see ``_cells``), ``clamped`` (k,) numbers of nodes, ``thickness`` (m)
    of the walls.
    """
    facets = np.concatenate(
        [group for name, group in sorted(surfaces.items()) if name.startswith("contact")]
    )
    nodes = points[facets]
    found = [in_reach(nodes, faces, face) for face in range(faces.axis.size)]
    axis = np.full(len(facets), 1)
    for face, group in enumerate(found):
        axis[group] = faces.axis[face]
    corners = np.where(
        axis[:, None, None] == 1,
        search.in_plane(points, facets, 1),
        search.in_plane(points, facets, 2),
    )
    counts = np.array(
        [_cells(faces, face, corners[group], cells) for face, group in enumerate(found)]
    )
    wall, planes = _planes(facets, points, corners, faces, found, counts)
    built = search.build(wall, planes)
    return Surface(
        places=points,
        facets=facets,
        map=_maps(corners, found),
        quadratic=True if facets.shape[1] == 6 else None,
        by_border=search.by_border(built, len(facets)),
        search=built,
        cells=counts,
        share=_share(points, facets, faces, found, counts),
        groups=group_faces([np.unique(facets[group]) for group in found], clamped),
        border=_border(corners, found),
        thickness=thickness,
        walls=np.unique(facets),
    )


def _maps(corners: np.ndarray, found: list[np.ndarray]) -> np.ndarray:
    """``Surface.map`` of facets with ``corners`` (m,k,2) m. Rows of facets that no face can touch
    are zero: they may be seen from their edge."""
    maps, reached = np.zeros((len(corners), 8)), np.unique(np.concatenate(found))
    maps[reached] = search.facet_maps(corners[reached])
    return maps


def _cells(faces, face: int, corners: np.ndarray, cells: int | None) -> tuple[int, int]:
    """Cells along the length and the width of a face over facets with ``corners`` (m,k,2) m: at
    least ``LEAST_CELLS``, and no longer than half a facet."""
    if cells is not None:
        return cells, cells
    if not len(corners):
        return LEAST_CELLS, LEAST_CELLS
    size = 2.0 * np.array([faces.half_length[face], faces.half_width[face]])
    along, across = np.ceil(_CELLS_PER_FACET * size / search.extent(corners) - 1e-6).astype(int)
    return max(LEAST_CELLS, int(along)), max(LEAST_CELLS, int(across))


def _planes(
    facets: np.ndarray,
    points: np.ndarray,
    corners: np.ndarray,
    faces,
    found: list[np.ndarray],
    counts: np.ndarray,
) -> tuple[np.ndarray, list[search.Plane]]:
    """Number (f,) of the wall of each face, -1 without one, and the walls. Faces that can touch the
    same facets share a wall."""
    sizes = 2.0 * np.column_stack([faces.half_length, faces.half_width]) / counts
    wall = np.full(len(found), -1)
    numbers: dict[bytes, int] = {}
    planes: list[search.Plane] = []
    for face, group in enumerate(found):
        if not group.size:
            continue
        key = group.tobytes()
        if key not in numbers:
            numbers[key] = len(planes)
            whole = facets[_facing(points[facets], faces, face)]
            edges = search.border(whole[:, : corners.shape[1]])
            ends = points[edges][:, :, [0, 3 - faces.axis[face]]]
            planes.append(
                search.Plane(
                    facets=group,
                    corners=corners[group],
                    on_border=np.isin(facets[group][:, : corners.shape[1]], edges).sum(axis=1) > 1,
                    ends=ends,
                    overlap=0.0,
                )
            )
        number = wall[face] = numbers[key]
        # half the diagonal of a cell
        overlap = max(planes[number].overlap, 0.5 * float(np.hypot(*sizes[face])))
        planes[number] = planes[number]._replace(overlap=overlap)
    return wall, planes


def _share(
    points: np.ndarray, facets: np.ndarray, faces, found: list[np.ndarray], counts: np.ndarray
) -> np.ndarray:
    """Upper bound (n,) m2, for any place of a face, of the sum over its cells on node a of
    A |N_a| sum over b of |N_b|.

    It is the integral over the facets of the node, and a bound of the difference between sum and
    integral: for points in rows a distance d apart, and a function that rises over a length h and
    falls again, half of (d/h)^2 in each direction.
    """
    shape, area = geometry.gauss(points[facets], _GAUSS)
    spread = np.abs(shape) * np.abs(shape).sum(axis=1, keepdims=True)
    share = np.zeros(len(points))
    np.add.at(share, facets, area @ spread)
    size = np.column_stack([faces.half_length, faces.half_width]) * 2.0 / counts
    worst = 1.0
    for face, group in enumerate(found):
        if group.size:
            least = np.ptp(points[facets[group]][:, :, [0, 3 - faces.axis[face]]], axis=1).min(
                axis=0
            )
            worst = max(worst, float((1.0 + 0.5 * (size[face] / least) ** 2).prod()))
    return worst * share


def _border(corners: np.ndarray, found: list[np.ndarray]) -> np.ndarray:
    """Least X, greatest X, and the same across the rail, (f,4) m, of the facets ``found`` for each
    face, with ``corners`` (m,k,2) m; infinity and minus infinity without facets."""
    border = np.tile([np.inf, -np.inf], (len(found), 2))
    for row, group in zip(border, found):
        if group.size:
            low, high = corners[group].min(axis=(0, 1)), corners[group].max(axis=(0, 1))
            row[:] = low[0], high[0], low[1], high[1]
    return border


def group_faces(nodes: list[np.ndarray], clamped: np.ndarray) -> Groups:
    """Groups of the faces, from the ``nodes`` within reach of each face."""
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
    )


def _starts(parts: list[np.ndarray]) -> np.ndarray:
    """First index of each part in the joined array, and the end of the last part."""
    return np.cumsum([0, *(part.size for part in parts)])


def magnification(surface: Surface) -> float:
    """Upper bound of the speed of a point of a facet over that of its fastest node: 1 where no
    nodal function is negative, else 5/3."""
    return 1.0 if surface.quadratic is None else 5.0 / 3.0


def in_reach(nodes: np.ndarray, faces, face: int) -> np.ndarray:
    """Numbers of the facets (nodes (m,k,3) m, axes of ``faces.wall``) that are opposite to face
    ``face`` and beside the track of its pad."""
    across = 3 - faces.axis[face]
    place, half = faces.centre[face, across], faces.half_width[face] + _MARGIN
    beside = (nodes[:, :, across].max(axis=1) > place - half) & (
        nodes[:, :, across].min(axis=1) < place + half
    )
    return np.flatnonzero(_facing(nodes, faces, face) & beside)


def _facing(nodes: np.ndarray, faces, face: int) -> np.ndarray:
    """Whether each facet is part of the wall of ``face``."""
    axis = faces.axis[face]
    facing = faces.sign[face] * geometry.normals(nodes)[:, axis] < _FACING
    return facing & (np.abs(nodes[:, :, axis].mean(axis=1) - faces.wall[face]) < _MARGIN)
