"""Strain gauges, one on each contact wall: the mean stress over a square patch of 4 mm, which
converges as the mesh is refined.

The stress at a sharp corner or at the border of a clamp does not converge. So the patches lie on
the track of the pads, in the middle of the last free span. Candidates are local maxima of the
distance from clamps and ends that are at least half of the largest distance. The candidate nearest
to the open end is taken, where the pads press last. Patches depend on the scene and on the clamps
of the mesh, never on its elements: 4 x 4 points in the middle of squares of 1 mm, each evaluated in
the element behind the wall (``elements.hexahedral_recovery``, ``elements.tetrahedral_recovery``).
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.contact import surface
from tipoff.highfi.elements import hexahedral_recovery, tetrahedral_recovery
from tipoff.highfi.mesh import facets as geometry
from tipoff.highfi.mesh.rail_mesh import RailMesh

SIDE = 4e-3  # m
_POINTS = 4  # along each side
_GRID = 1e-3  # m between candidate stations
_RECOVERY = {8: hexahedral_recovery, 10: tetrahedral_recovery}  # by the nodes of an element


class Patch(NamedTuple):
    """Patches of gauges on w walls."""

    centre: np.ndarray  # (w,3) m, in the axes of the points of ``find``
    node: np.ndarray  # (w,k) numbers in the nodal arrays
    # (w,6,3k) Pa/m, from the displacement of those nodes to the mean stress, padded with zeros
    matrix: np.ndarray


def find(
    mesh: RailMesh, faces, points: np.ndarray, law: np.ndarray, number: np.ndarray
) -> Patch | None:
    """Patches of a mesh whose points (n,3) m are in the axes of ``faces.wall``; None if no pad has
    a wall, or no station has space for a patch on each wall.

    ``law`` (6,6) Pa; ``number`` (n,) of each node in the nodal arrays.
    """
    names = sorted(name for name in mesh.surfaces if name.startswith("contact"))
    facets = np.concatenate([mesh.surfaces[name] for name in names])
    walls = _walls(points[facets], faces)
    if not walls:
        return None
    for station in _stations(points, mesh, facets):
        spots = [
            _spots(points, facets[near], axis, (station, across)) for near, axis, across in walls
        ]
        if all(spot is not None for spot in spots):
            return _assembled(mesh, points, spots, law, number)
    return None


def stress(patch: Patch, displacement: np.ndarray) -> np.ndarray:
    """Mean stress (w,6) Pa of each patch under displacement (n,3) m."""
    moved = displacement[patch.node].reshape(len(patch.node), -1, 1)
    return (patch.matrix @ moved)[..., 0]


def _walls(corners: np.ndarray, faces) -> list[tuple[np.ndarray, int, float]]:
    """(facets, normal axis, middle of the track across it) of each wall along which a pad runs."""
    found = {}
    for face in range(faces.axis.size):
        axis, across = int(faces.axis[face]), faces.centre[face, 3 - faces.axis[face]]
        key = (axis, round(1e6 * faces.wall[face]), round(1e6 * across))
        near = surface.in_reach(corners, faces, face)
        if key not in found and near.size:
            found[key] = near, axis, across
    return list(found.values())


def _stations(points: np.ndarray, mesh: RailMesh, facets: np.ndarray) -> np.ndarray:
    """Candidate places along X for the middle of the patches, best first."""
    start, end = points[facets][:, :, 0].min(), points[facets][:, :, 0].max()
    tried = np.arange(start + 0.5 * SIDE, end - 0.5 * SIDE + 1e-9, _GRID)
    held = points[mesh.surfaces["mount"]][:, :, 0]
    clamp = np.maximum(held.min(axis=1) - tried[:, None], tried[:, None] - held.max(axis=1)).min(
        axis=1, initial=np.inf
    )
    # In tenths of a micrometre, so that equal distances are equal on every mesh.
    free = np.round(1e7 * np.minimum(np.minimum(clamp, tried - start), end - tried).clip(min=0.0))
    around = np.concatenate([[-1.0], free, [-1.0]])
    middle = (free >= around[:-2]) & (free >= around[2:]) & (2.0 * free >= free.max())
    return tried[np.lexsort((np.where(middle, -tried, -free), ~middle))]


def _spots(
    points: np.ndarray, facets: np.ndarray, axis: int, middle: tuple[float, float]
) -> list[tuple[np.ndarray, np.ndarray]] | None:
    """Facet (k,) of each point of the patch around ``middle`` (x, across), and the weights (k,) of
    its nodes there."""
    offsets = (np.arange(_POINTS) + 0.5) * SIDE / _POINTS - 0.5 * SIDE
    plane = points[facets][:, :, [0, 3 - axis]]
    hull, slack = geometry.hull(plane), geometry.INSIDE * SIDE
    low, high = hull.min(axis=1) - slack, hull.max(axis=1) + slack
    found = []
    for target in np.stack(
        np.meshgrid(*(place + offsets for place in middle), indexing="ij"), axis=-1
    ).reshape(-1, 2):
        around = np.flatnonzero(((low < target) & (target < high)).all(axis=1))
        values, inside = geometry.weights(plane[around], np.broadcast_to(target, (around.size, 2)))
        if not inside.any():
            return None
        found.append((facets[around[inside.argmax()]], values[inside.argmax()]))
    return found


def _assembled(
    mesh: RailMesh, points: np.ndarray, spots: list, law: np.ndarray, number: np.ndarray
) -> Patch:
    """Matrix of the mean over the points of each wall."""
    facets = np.array([facet for wall in spots for facet, _ in wall])
    weights = np.array([weight for wall in spots for _, weight in wall])
    cells, formulas = _behind(mesh.cells, facets), _RECOVERY[mesh.cells.shape[1]]
    place = (cells[:, None] == facets[:, :, None]).argmax(axis=2)
    local = np.einsum("pa,pai->pi", weights, formulas.NODES[place])
    matrix = law @ formulas.strain_matrix(points[cells], law, local) / _POINTS**2
    centre = (
        np.einsum("pa,pai->pi", weights, points[facets]).reshape(len(spots), -1, 3).mean(axis=1)
    )
    walls = cells.reshape(len(spots), _POINTS**2, -1), matrix.reshape(len(spots), _POINTS**2, 6, -1)
    parts = [_summed(nodes, part) for nodes, part in zip(*walls)]
    size = max(len(nodes) for nodes, _ in parts)
    node, whole = np.zeros((len(parts), size), dtype=np.int64), np.zeros((len(parts), 6, size, 3))
    for wall, (nodes, part) in enumerate(parts):
        node[wall, : len(nodes)], whole[wall, :, : len(nodes)] = number[nodes], part
    return Patch(centre, node, whole.reshape(len(parts), 6, -1))


def _behind(cells: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Nodes (p,k) of the element behind each facet (p,f)."""
    size = facets.shape[1]
    near = cells[np.isin(cells, facets).sum(axis=1) >= size]
    return near[[np.flatnonzero(np.isin(near, facet).sum(axis=1) == size)[0] for facet in facets]]


def _summed(cells: np.ndarray, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (k,) of the elements (p,f) around the points of one wall, and the sum (6,k,3) of the
    contributions of the elements."""
    nodes, place = np.unique(cells, return_inverse=True)
    total = np.zeros((len(nodes), 6, 3))
    np.add.at(
        total,
        place.ravel(),
        matrix.reshape(len(cells), 6, -1, 3).transpose(0, 2, 1, 3).reshape(-1, 6, 3),
    )
    return nodes, total.transpose(1, 0, 2)
