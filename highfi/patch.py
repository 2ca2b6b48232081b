"""A strain gauge on each contact wall: the mean stress over a square of 4 mm, which a finer mesh brings nearer to one value.

The stress at a sharp corner or at the border of a clamp has no such value: it grows with every refinement. So the patches lie on
the track of the pads, in the middle of the last free span: of the places farther from any clamp and from the ends than those
beside them, and at least half as far as the farthest, the one nearest to the open end, where the last pads press. They depend on
the scene and on where the mesh is clamped, never on its elements: 4 x 4 points at the middles of squares of 1 mm, each seen from
the element behind the wall (``highfi.recovery``).
"""

from typing import NamedTuple

import numpy as np

from highfi import element, recovery, surface
from highfi.mesh import RailMesh

SIDE = 4e-3  # m
_POINTS = 4  # along each side
_GRID = 1e-3  # m between the stations tried
_NEWTON = 20
_INSIDE = 1e-6  # how far outside its facet, in local coordinates, a point may seem to lie


class Patch(NamedTuple):
    """Constant: centre (w,3) m of the patches in the axes of the points they were found with; node (w,k) numbers in the nodal
    arrays and matrix (w,6,3k) Pa/m, from the displacement of those nodes to the mean stress, padded with zeros to the largest k."""

    centre: np.ndarray
    node: np.ndarray
    matrix: np.ndarray


def find(mesh: RailMesh, faces, points: np.ndarray, law: np.ndarray, number: np.ndarray) -> Patch | None:
    """Patches of a mesh whose points (n,3) m are in the axes of ``faces.wall``; None where no pad has a wall, or no station room
    for a patch on each.

    ``law`` (6,6) Pa; ``number`` (n,) of each node in the nodal arrays.
    """
    names = sorted(name for name in mesh.surfaces if name.startswith("contact"))
    facets = np.concatenate([mesh.surfaces[name] for name in names])
    walls = _walls(points[facets], faces)
    if not walls:
        return None
    for station in _stations(points, mesh, facets):
        spots = [_spots(points, facets[near], axis, (station, across)) for near, axis, across in walls]
        if all(spot is not None for spot in spots):
            return _assembled(mesh, points, spots, law, number)
    return None


def stress(patch: Patch, displacement: np.ndarray) -> np.ndarray:
    """Mean stress (w,6) Pa of each patch under displacement (n,3) m."""
    moved = displacement[patch.node].reshape(len(patch.node), -1, 1)
    return (patch.matrix @ moved)[..., 0]


def _walls(corners: np.ndarray, faces) -> list[tuple[np.ndarray, int, float]]:
    """(facets, normal axis, middle of the track across it) of each wall that some pad runs along."""
    found = {}
    for face in range(faces.axis.size):
        axis, across = int(faces.axis[face]), faces.centre[face, 3 - faces.axis[face]]
        key = (axis, round(1e6 * faces.wall[face]), round(1e6 * across))
        near = surface.in_reach(corners, faces, face)
        if key not in found and near.size:
            found[key] = near, axis, across
    return list(found.values())


def _stations(points: np.ndarray, mesh: RailMesh, facets: np.ndarray) -> np.ndarray:
    """Places along X that could be the middle of the patches, best first."""
    start, end = points[facets][:, :, 0].min(), points[facets][:, :, 0].max()
    tried = np.arange(start + 0.5 * SIDE, end - 0.5 * SIDE + 1e-9, _GRID)
    held = points[mesh.surfaces["mount"]][:, :, 0]
    clamp = np.maximum(held.min(axis=1) - tried[:, None], tried[:, None] - held.max(axis=1)).min(axis=1, initial=np.inf)
    # In tenths of a micrometre, so that places which tie do so on every mesh.
    free = np.round(1e7 * np.minimum(np.minimum(clamp, tried - start), end - tried).clip(min=0.0))
    around = np.concatenate([[-1.0], free, [-1.0]])
    middle = (free >= around[:-2]) & (free >= around[2:]) & (2.0 * free >= free.max())
    return tried[np.lexsort((np.where(middle, -tried, -free), ~middle))]


def _spots(points: np.ndarray, facets: np.ndarray, axis: int,
           middle: tuple[float, float]) -> list[tuple[np.ndarray, np.ndarray]] | None:
    """For each point of the patch around ``middle`` (x, across) its facet (4,) and the weights (4,) of its corners there."""
    offsets = (np.arange(_POINTS) + 0.5) * SIDE / _POINTS - 0.5 * SIDE
    plane = points[facets][:, :, [0, 3 - axis]]
    low, high = plane.min(axis=1) - _INSIDE * SIDE, plane.max(axis=1) + _INSIDE * SIDE
    found = []
    for target in np.stack(np.meshgrid(*(place + offsets for place in middle), indexing="ij"), axis=-1).reshape(-1, 2):
        around = np.flatnonzero(((low < target) & (target < high)).all(axis=1))
        spots = [(facets[facet], weights) for facet in around if (weights := _weights(plane[facet], target)) is not None]
        if not spots:
            return None
        found.append(spots[0])
    return found


def _weights(corners: np.ndarray, target: np.ndarray) -> np.ndarray | None:
    """Bilinear weights (4,) of the corners (4,2) of a plane facet at a point in it, None for one outside; by Newton's rule."""
    place = np.full(2, 0.5)
    for _ in range(_NEWTON):
        r, s = place
        weights = np.array([(1.0 - r) * (1.0 - s), r * (1.0 - s), r * s, (1.0 - r) * s])
        slopes = np.array([[s - 1.0, 1.0 - s, s, -s], [r - 1.0, -r, r, 1.0 - r]])
        place = place + np.linalg.solve((slopes @ corners).T, target - weights @ corners)
    return weights if (np.abs(place - 0.5) < 0.5 + _INSIDE).all() else None


def _assembled(mesh: RailMesh, points: np.ndarray, spots: list, law: np.ndarray, number: np.ndarray) -> Patch:
    """The mean over the points of each wall as one matrix."""
    facets = np.array([facet for wall in spots for facet, _ in wall])
    weights = np.array([weight for wall in spots for _, weight in wall])
    hexes = _behind(mesh.cells, facets)
    corner = (hexes[:, None] == facets[:, :, None]).argmax(axis=2)
    local = np.einsum("pa,pai->pi", weights, element.VTK_CORNERS[corner].astype(float))
    matrix = law @ recovery.strain_matrix(points[hexes], law, local) / _POINTS**2
    centre = np.einsum("pa,pai->pi", weights, points[facets]).reshape(len(spots), -1, 3).mean(axis=1)
    parts = [_summed(nodes, part) for nodes, part in zip(hexes.reshape(len(spots), -1, 8), matrix.reshape(len(spots), -1, 6, 24))]
    size = max(len(nodes) for nodes, _ in parts)
    node, whole = np.zeros((len(parts), size), dtype=np.int64), np.zeros((len(parts), 6, size, 3))
    for wall, (nodes, part) in enumerate(parts):
        node[wall, :len(nodes)], whole[wall, :, :len(nodes)] = number[nodes], part
    return Patch(centre, node, whole.reshape(len(parts), 6, -1))


def _behind(hexes: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Corners (p,8) of the element that each facet (p,4) bounds."""
    near = hexes[np.isin(hexes, facets).sum(axis=1) >= 4]
    return near[[np.flatnonzero(np.isin(near, facet).sum(axis=1) == 4)[0] for facet in facets]]


def _summed(hexes: np.ndarray, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (k,) of the elements (p,8) around the points of one wall, and the sum (6,k,3) of what each of them brings."""
    nodes, place = np.unique(hexes, return_inverse=True)
    total = np.zeros((len(nodes), 6, 3))
    np.add.at(total, place.ravel(), matrix.reshape(len(hexes), 6, 8, 3).transpose(0, 2, 1, 3).reshape(-1, 6, 3))
    return nodes, total.transpose(1, 0, 2)
