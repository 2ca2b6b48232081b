"""Values between the stations of a rail compliance."""

import itertools
from collections.abc import Sequence

import numpy as np

from tipoff.mechanics.rail_compliance import pairs

_STRAIGHT = 1e-9  # in xi; smaller changes of a slope are rounding


def cubic(
    travel: np.ndarray, values: np.ndarray, breaks: Sequence[tuple[int, ...]] | None = None
) -> np.ndarray:
    """Cubic splines (s-1,k,...,4) through ``values`` (s,k,...) at ``travel`` (s,) m: coefficients of
    the rising powers of the distance (m) from the station before. At the stations of these numbers,
    the ``breaks`` of each of the k, ascending, a slope may jump."""
    found = np.zeros((len(travel) - 1, *values.shape[1:], 4))
    if not values.size:
        return found
    given = breaks or [()] * values.shape[1]
    for own in set(given):
        same = [number for number, each in enumerate(given) if each == own]
        found[:, same] = _between(travel, values[:, same], own)
    return found


def between_faces(
    travel: np.ndarray,
    table: np.ndarray,
    rail: np.ndarray,
    on_part: np.ndarray,
    breaks: Sequence[tuple[int, ...]],
) -> np.ndarray:
    """Splines (s-1,f,m,4,p p) through a ``table`` (s,f,m,p,p) between the faces on each ``rail``
    (``pairs``), in the patterns of the parts that ``on_part`` (s,f,q,q) turns those of whole faces into.
    A slope may jump at the ``breaks`` of either face."""
    stations, faces, members, size, _ = table.shape
    part = pairs.on_both_sides(on_part[..., :size, :size].swapaxes(-1, -2), table, rail)
    own = [
        tuple(sorted({*each, *(breaks[face] if face >= 0 else ())}))
        for each, near in zip(breaks, pairs.beside(rail))
        for face in near
    ]
    found = cubic(travel, part.reshape(stations, faces * members, size, size), own)
    found = found.transpose(0, 1, 4, 2, 3).reshape(stations - 1, faces, members, 4, -1)
    return np.ascontiguousarray(found)


def _between(travel: np.ndarray, values: np.ndarray, breaks: tuple[int, ...]) -> np.ndarray:
    from scipy.interpolate import CubicSpline

    parts = [
        CubicSpline(travel[first : last + 1], values[first : last + 1]).c[::-1]
        for first, last in itertools.pairwise((0, *breaks, len(travel) - 1))
    ]
    return np.moveaxis(np.concatenate(parts, axis=1), 0, -1)


def breaks(part: np.ndarray) -> list[tuple[int, ...]]:
    """For each face, the numbers of the stations at which it begins to leave the wall, or its part with a
    wall (s,f,2) begins to move or stops: slopes jump there. A jump between two stations has no
    number."""
    bends = np.abs(np.diff(part, 2, axis=0)).max(axis=2) > _STRAIGHT
    beside = np.zeros_like(bends)
    beside[1:] |= bends[:-1]
    beside[:-1] |= bends[1:]
    return [tuple((np.flatnonzero(own) + 1).tolist()) for own in (bends & ~beside).T]
