"""Search structure of the walls: bins with the facets over them, and the borders of the walls."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tipoff.highfi.state.records import Search

_SLACK = 1e-9  # of a bin; a smaller overlap is ignored
_MOST_BINS = 8  # per facet


class Plane(NamedTuple):
    """One wall, seen along its normal."""

    facets: np.ndarray  # (m,) numbers of the facets that pads can come over
    corners: np.ndarray  # (m,3 or 4,2) m, X and place across of their corners
    on_border: np.ndarray  # (m,) whether an edge of the facet may be part of the border
    ends: np.ndarray  # (e,2,2) m, ends of the pieces of the border of the whole wall
    # m, largest distance beyond the border of the middle of a cell that still overlaps the wall
    overlap: float


def facet_maps(corners: np.ndarray) -> np.ndarray:
    """Rows (m,8) of ``Surface.map`` of facets with corners (m,3 or 4,2) m in the plane of their
    wall."""
    count = corners.shape[1]
    if count == 4:
        origin = corners.mean(axis=1)
        by_r, by_s, twist = (
            0.25 * np.einsum("c,mci->mi", signs, corners)
            for signs in ([-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0])
        )
        # rounding errors of a parallelogram
        twist[np.abs(twist).max(axis=1) < 1e-12 * np.ptp(corners, axis=1).max(axis=1)] = 0.0
    else:
        origin, twist = corners[:, 0], np.zeros((len(corners), 2))
        by_r, by_s = corners[:, 1] - origin, corners[:, 2] - origin
    inverse = np.linalg.inv(np.stack([by_r, by_s], axis=2))
    bent = (inverse @ twist[:, :, None])[:, :, 0]
    return np.concatenate([origin, inverse.reshape(-1, 4), bent], axis=1)


def border(corners: np.ndarray) -> np.ndarray:
    """Edges (e,2), as node numbers, that only one of the facets with ``corners`` (m,3 or 4) has."""
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    found, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return found[count == 1]


def build(wall: np.ndarray, planes: Sequence[Plane]) -> Search:
    """Search structure of ``planes``; ``wall`` (f,) is the number of the plane of each face."""
    parts = [_bins(plane) for plane in planes]
    counts = np.array([part.bins for part in parts], dtype=np.int64).reshape(-1, 2)
    sizes = counts.prod(axis=1)
    pieces = np.cumsum([0, *(len(plane.ends) for plane in planes)])
    return Search(
        wall=wall,
        low=np.array([part.low for part in parts]).reshape(-1, 2),
        per_length=np.array([part.per_length for part in parts]).reshape(-1, 2),
        bins=counts,
        first_bin=np.cumsum([0, *sizes])[:-1].astype(np.int64),
        first_facet=_starts([part.facets_in_bin for part in parts]),
        facet=_joined([part.facet for part in parts]),
        first_edge=_starts([part.edges_in_bin for part in parts]),
        edge=_joined([part.edge + first for part, first in zip(parts, pieces)]),
        ends=np.concatenate([np.zeros((0, 4)), *(plane.ends.reshape(-1, 4) for plane in planes)]),
    )


def by_border(search: Search, facets: int) -> np.ndarray:
    """``Surface.by_border`` (facets,): facets over bins that contain pieces of the border."""
    found = np.zeros(facets, dtype=np.bool_)
    has_edges = np.diff(search.first_edge) > 0
    found[search.facet[np.repeat(has_edges, np.diff(search.first_facet))]] = True
    return found


class _Bins(NamedTuple):
    """Bins of one wall; ``Search`` has the meaning of the fields."""

    low: np.ndarray  # (2,) m
    per_length: np.ndarray  # (2,) 1/m
    bins: np.ndarray  # (2,)
    facets_in_bin: np.ndarray  # number of entries of each bin in ``facet``
    facet: np.ndarray
    edges_in_bin: np.ndarray  # number of entries of each bin in ``edge``
    edge: np.ndarray


def _starts(counts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(_joined(counts))])


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.zeros(0, dtype=np.int64), *parts])


def _bins(plane: Plane) -> _Bins:
    low, high = plane.corners.min(axis=1), plane.corners.max(axis=1)
    size = np.median(high - low, axis=0)
    first, last = low.min(axis=0), high.max(axis=0)
    most = np.sqrt(_MOST_BINS * len(low) / ((last - first) / size).prod())
    size = size / min(1.0, most)
    # Bins begin at the corner of the wall, so the bins of an even mesh are its facets.
    first = first - size * np.ceil(plane.overlap / size)
    count = np.ceil((last + plane.overlap - first) / size - _SLACK).astype(np.int64)
    reach = np.where(plane.on_border[:, None], plane.overlap, 0.0)
    facet, over = _pairs((low - reach - first) / size, (high + reach - first) / size, count)
    away = np.abs((plane.corners.mean(axis=1)[facet] - first) / size - _middles(over, count))
    facets_in_bin, order = _sorted(over, count, (facet, away.max(axis=1)))
    ends_low, ends_high = plane.ends.min(axis=1), plane.ends.max(axis=1)
    piece, beside = _pairs(
        (ends_low - plane.overlap - first) / size, (ends_high + plane.overlap - first) / size, count
    )
    edges_in_bin, along = _sorted(beside, count, (piece,))
    return _Bins(
        low=first,
        per_length=1.0 / size,
        bins=count,
        facets_in_bin=facets_in_bin,
        facet=plane.facets[facet[order]],
        edges_in_bin=edges_in_bin,
        edge=piece[along],
    )


def _pairs(low: np.ndarray, high: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the boxes, and of the bins that they overlap; the unit of boxes (m,2) is a bin."""
    start = np.floor(low + _SLACK).astype(np.int64).clip(0, count - 1)
    stop = np.ceil(high - _SLACK).astype(np.int64).clip(start + 1, count)
    along, across = (stop - start).T
    box = np.repeat(np.arange(len(low)), along * across)
    place = np.arange(box.size) - np.repeat(
        np.cumsum(along * across) - along * across, along * across
    )
    i = start[box, 0] + place // across[box]
    j = start[box, 1] + place % across[box]
    return box, i * count[1] + j


def _middles(bins: np.ndarray, count: np.ndarray) -> np.ndarray:
    return np.stack([bins // count[1], bins % count[1]], axis=1) + 0.5


def _sorted(bins: np.ndarray, count: np.ndarray, keys: tuple) -> tuple[np.ndarray, np.ndarray]:
    """Entries in each bin, and the order of the entries by bin, then by the last of ``keys``."""
    return np.bincount(bins, minlength=count.prod()), np.lexsort((*keys, bins))


def in_plane(points: np.ndarray, facets: np.ndarray, axis: int) -> np.ndarray:
    """X and place across (m,3 or 4,2) m of the corners of ``facets`` (m,k), seen along ``axis``."""
    corners = facets[:, : 4 if facets.shape[1] == 4 else 3]
    return points[corners][:, :, [0, 3 - axis]]


def extent(corners: np.ndarray) -> np.ndarray:
    """Median extent (2,) m of facets with ``corners`` (m,3 or 4,2) m along X and across."""
    return np.median(np.ptp(corners, axis=1), axis=0)
