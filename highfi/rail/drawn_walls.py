"""Walls of a rail file as drawn: their offset from the straight walls of the scene, along the track
of each pad face.

With h the coordinate of the wall along its axis, n = +-1 the sign of the face's normal, and
``wall`` the place of the straight wall, the offset away from the payload at a place X of the rail
is

    W(X, eta) = n h - n wall  =  w_0(X) + w_1(X) eta + w_2(X) eta^2

by least squares over the width of the face, eta from -1 to 1 (``mechanics.drawn_walls``). There is
no fit along the rail: draft, bow, steps and joints are sampled at places ``SPACING`` apart.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.contact import surface
from tipoff.highfi.mesh import facets as geometry
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics.pressure import every, located
from tipoff.mechanics.drawn_walls import ACROSS, grid
from tipoff.mechanics.model import Faces

SAME = 1e-6  # m, below the manufacturing tolerance of a rail, above the rounding of mesh formats
_SAMPLES = 6  # places across the width of a face, in the middle of equal strips
_TOGETHER = 64  # places along the rail located at once; bounds the memory
_END = 1e-8  # m, tolerance of nodes at the end of a piece of wall
_SINGULAR = (
    1e-6  # of the largest eigenvalue: powers of eta that hardly differ on what wall there is
)


class Track(NamedTuple):
    """The wall under the track of one pad face, at n places along the rail."""

    place: np.ndarray  # (n,) m, X
    offset: np.ndarray  # (n, ACROSS) m, w_0, w_1 and w_2
    gap: np.ndarray  # (n,) m, mean of W
    missed: np.ndarray  # (n,) m, largest distance of the wall from the powers of eta


def corners(mesh: RailMesh) -> np.ndarray:
    """Nodes (m,k,3) m of all facets of the walls."""
    return mesh.points[
        np.concatenate(
            [group for name, group in sorted(mesh.surfaces.items()) if name.startswith("contact")]
        )
    ]


def under(nodes: np.ndarray, faces: Faces, face: int, reach: tuple[float, float]) -> np.ndarray:
    """Nodes (m,k,3) m of the facets, of those with ``nodes``, that lie under the track of a face
    between the X (m) of ``reach``; all in the axes of ``faces.wall``."""
    near = nodes[surface.in_reach(nodes, faces, face)]
    across = 3 - faces.axis[face]
    side = np.abs(near[:, :, across] - faces.centre[face, across]).min(axis=1)
    low, high = near[:, :, across].min(axis=1), near[:, :, across].max(axis=1)
    middle, half = faces.centre[face, across], faces.half_width[face] - SAME
    beside = (low < middle + half) & (high > middle - half)
    beside |= side < half
    ahead = (near[:, :, 0].max(axis=1) > reach[0]) & (near[:, :, 0].min(axis=1) < reach[1])
    return near[beside & ahead]


def away(near: np.ndarray, faces: Faces, face: int) -> np.ndarray:
    """Offset (m,k) m, away from the payload, of facets with nodes ``near`` (m,k,3) m."""
    return faces.sign[face] * (near[:, :, faces.axis[face]] - faces.wall[face])


def track(
    near: np.ndarray, faces: Faces, face: int, half: float, reach: tuple[float, float]
) -> Track:
    """The wall under the track of a face, from facets with nodes ``near`` (m,k,3) m. ``half`` (m)
    is half the width of the face, negative if eta is opposite to the axis. In places without
    facets, the wall is interpolated between its neighbours."""
    x, eta = grid(*reach), (np.arange(_SAMPLES) + 0.5) * 2.0 / _SAMPLES - 1.0
    across = 3 - faces.axis[face]
    plane, height = near[:, :, [0, across]], away(near, faces, face)
    control = geometry.hull(plane)
    side = faces.centre[face, across] + half * eta
    found = np.full((x.size, _SAMPLES), np.nan)
    for first in range(0, x.size, _TOGETHER):
        part = x[first : first + _TOGETHER]
        place = np.stack(np.meshgrid(part, side, indexing="ij"), axis=-1).reshape(-1, 2)
        number, facet, weight = located(plane, control, place)
        values = np.full(len(place), np.nan)
        values[number] = (weight * height[facet]).sum(axis=1)
        found[first : first + part.size] = values.reshape(-1, _SAMPLES)
    return _fitted(x, found, eta)


def _fitted(x: np.ndarray, found: np.ndarray, eta: np.ndarray) -> Track:
    powers = eta[:, None] ** np.arange(ACROSS)
    has = np.isfinite(found)
    values = np.where(has, found, 0.0)
    gram = np.einsum("xq,qa,qb->xab", has.astype(float), powers, powers)
    inverse = np.linalg.pinv(gram, rcond=_SINGULAR, hermitian=True)
    offset = np.einsum("xab,qb,xq->xa", inverse, powers, values)
    missed = (np.abs(values - offset @ powers.T) * has).max(axis=1)
    count = has.sum(axis=1)
    gap = values.sum(axis=1) / np.maximum(count, 1)
    known, places = np.flatnonzero(count), np.arange(len(found))
    if known.size and known.size < len(found):
        for column in (*offset.T, gap):
            column[:] = np.interp(places, known, column[known])
    return Track(x, offset, gap, missed)


def step(near: np.ndarray, faces: Faces, face: int) -> tuple[float, float]:
    """Height (m) and X (m) of the highest step in the wall under the track of a face; ``near``
    (m,k,3) m: nodes of the facets. A step is where facets meet at two heights, or where a piece
    without wall ends at another height than the adjacent slopes continue to."""
    return max(_meeting(near, faces, face), _over_gaps(near, faces, face))


def _meeting(near: np.ndarray, faces: Faces, face: int) -> tuple[float, float]:
    plane, height = near[:, :, [0, 3 - faces.axis[face]]], away(near, faces, face)
    control, highest = geometry.hull(plane), (0.0, 0.0)
    places = np.unique(plane.reshape(-1, 2), axis=0)
    for first in range(0, len(places), _TOGETHER):
        part = places[first : first + _TOGETHER]
        number, facet, weight = every(plane, control, part)
        values = (weight * height[facet]).sum(axis=1)
        low, high = np.full(len(part), np.inf), np.full(len(part), -np.inf)
        np.minimum.at(low, number, values)
        np.maximum.at(high, number, values)
        most = int((high - low).argmax())
        highest = max(highest, (float(high[most] - low[most]), float(part[most, 0])))
    return highest


def _over_gaps(near: np.ndarray, faces: Faces, face: int) -> tuple[float, float]:
    height, normal = away(near, faces, face), geometry.normals(near)
    across = near[:, :, 3 - faces.axis[face]]
    slope = -faces.sign[face] * normal[:, 0] / normal[:, faces.axis[face]]
    highest = (0.0, 0.0)
    for before, after in gaps(near):
        ends = [np.abs(near[:, :, 0] - x) < _END for x in (before, after)]
        side = np.unique(across[ends[0] | ends[1]])
        order = [np.argsort(across[end]) for end in ends]
        first, second = (
            np.interp(side, across[end][sort], height[end][sort]) for end, sort in zip(ends, order)
        )
        beside, rise = slope[(ends[0] | ends[1]).any(axis=1)] * (after - before), second - first
        apart = max((rise - beside.max()).max(), (beside.min() - rise).max())
        highest = max(highest, (float(apart), before))
    return highest


def gaps(near: np.ndarray) -> list[tuple[float, float]]:
    """Pieces (m) along X that have none of the facets with nodes ``near`` (m,k,3) m but lie between
    them."""
    low, high = near[:, :, 0].min(axis=1), near[:, :, 0].max(axis=1)
    order = np.argsort(low)
    reached, starts = np.maximum.accumulate(high[order])[:-1], low[order][1:]
    return [(float(a), float(b)) for a, b in zip(reached, starts) if b - a > _END]


def offsets(
    mesh: RailMesh, faces: Faces, half: np.ndarray, reach: tuple[float, float]
) -> np.ndarray | None:
    """Offset (n,f,ACROSS) m of the walls under f faces at the places ``grid`` of ``reach`` (m), in
    the axes of ``faces.wall``; ``half`` (f,) m as in ``track``. Zero for a wall within ``SAME`` of
    the straight one; None if all walls are."""
    nodes = corners(mesh)
    found = np.zeros((grid(*reach).size, faces.axis.size, ACROSS))
    for face in range(faces.axis.size):
        near = under(nodes, faces, face, reach)
        if len(near) and np.abs(away(near, faces, face)).max() > SAME:
            found[:, face] = track(near, faces, face, half[face], reach).offset
    return found if found.any() else None
