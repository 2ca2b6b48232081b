"""Values between the stations of a rail compliance."""

import itertools
from collections.abc import Sequence

import numpy as np

from tipoff.mechanics.rail_compliance import pairs

_AT_ONCE = 1e7  # bytes of a table between faces
_SHORT = 4  # stations, below which the equations of the slopes are others
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
        rows = values[:, same].reshape(len(travel), -1)
        spline = _between(travel, rows, own).swapaxes(1, 2)
        found[:, same] = spline.reshape(-1, len(same), *values.shape[2:], 4)
    return found


def between_faces(
    travel: np.ndarray,
    table: np.ndarray,
    rail: np.ndarray,
    on_part: np.ndarray,
    breaks: Sequence[tuple[int, ...]],
    once: bool,
) -> np.ndarray:
    """Splines (s-1,k,4,p p) through the k blocks of a ``table`` (s,f,m,p,p) between the faces on each
    ``rail`` that are stored, ``once`` for both orders of a pair or not (``pairs.numbered``), in the patterns
    of the parts that ``on_part`` (s,f,q,q) turns those of whole faces into. A slope may jump at the
    ``breaks`` of either face."""
    stations, _, _, size, _ = table.shape
    part = on_part[..., :size, :size].swapaxes(-1, -2)
    near, (number, turned) = pairs.beside(rail), pairs.numbered(rail, once)
    every = [(face, place, near[face, place]) for face, place in np.argwhere((near >= 0) & ~turned)]
    found = np.zeros((stations - 1, len(every), 4, size * size))
    alike: dict[tuple[int, ...], list] = {}
    for pair in every:
        own = tuple(sorted({*breaks[pair[0]], *breaks[pair[2]]}))
        alike.setdefault(own, []).append(pair)
    most = max(1, int(_AT_ONCE / (8 * stations * size**2)))
    for own, those in alike.items():
        for first in range(0, len(those), most):  # the table of a long rail is large
            face, place, other = np.array(those[first : first + most]).T
            block = part[:, face] @ table[:, face, place] @ part[:, other].swapaxes(-1, -2)
            spline = _between(travel, block.reshape(stations, -1), own)
            spline = spline.reshape(stations - 1, 4, face.size, -1)
            found[:, number[face, place]] = spline.swapaxes(1, 2)
    return found


def _between(travel: np.ndarray, values: np.ndarray, breaks: tuple[int, ...]) -> np.ndarray:
    """Splines (s-1,4,k) through ``values`` (s,k), each between two of the ``breaks`` without knots at
    the second and the last but one of its stations."""
    from scipy.interpolate import CubicSpline

    found = np.empty((len(travel) - 1, 4, values.shape[1]))
    for first, last in itertools.pairwise((0, *breaks, len(travel) - 1)):
        x, y = travel[first : last + 1], values[first : last + 1]
        out = found[first:last]
        if len(x) < _SHORT:
            out[:] = CubicSpline(x, y).c[::-1].swapaxes(0, 1)
            continue
        step = np.diff(x)[:, None]
        rise = np.diff(y, axis=0) / step
        slope = _slopes(x, y, step, rise)
        bend = (slope[:-1] + slope[1:] - 2 * rise) / step
        out[:, 0], out[:, 1] = y[:-1], slope[:-1]
        out[:, 2], out[:, 3] = (rise - slope[:-1]) / step - bend, bend / step
    return found


def _slopes(x: np.ndarray, y: np.ndarray, step: np.ndarray, rise: np.ndarray) -> np.ndarray:
    """Slopes (s,k) of the spline through ``y`` (s,k) at ``x`` (s,). That of SciPy checks and copies the
    values several times, which takes longer than the solution."""
    from scipy.linalg import solve_banded

    dx = step[:, 0]
    matrix, right = np.zeros((3, len(x))), np.empty_like(y)
    matrix[1, 1:-1], matrix[0, 2:], matrix[2, :-2] = 2 * (dx[:-1] + dx[1:]), dx[:-1], dx[1:]
    right[1:-1] = 3 * (step[1:] * rise[:-1] + step[:-1] * rise[1:])
    ahead, behind = x[2] - x[0], x[-1] - x[-3]
    matrix[1, 0], matrix[0, 1], matrix[1, -1], matrix[2, -2] = dx[1], ahead, dx[-2], behind
    right[0] = ((step[0] + 2 * ahead) * step[1] * rise[0] + step[0] ** 2 * rise[1]) / ahead
    right[-1] = (step[-1] ** 2 * rise[-2] + (2 * behind + step[-1]) * step[-2] * rise[-1]) / behind
    return solve_banded(
        (1, 1), matrix, right, overwrite_ab=True, overwrite_b=True, check_finite=False
    )


def breaks(part: np.ndarray) -> list[tuple[int, ...]]:
    """For each face, the numbers of the stations at which it begins to leave the wall, or its part with a
    wall (s,f,2) begins to move or stops: slopes jump there. A jump between two stations has no
    number."""
    bends = np.abs(np.diff(part, 2, axis=0)).max(axis=2) > _STRAIGHT
    beside = np.zeros_like(bends)
    beside[1:] |= bends[:-1]
    beside[:-1] |= bends[1:]
    return [tuple((np.flatnonzero(own) + 1).tolist()) for own in (bends & ~beside).T]
