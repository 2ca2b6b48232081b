"""Values between the stations of a rail compliance."""

import itertools
from collections.abc import Sequence

import numpy as np

_STRAIGHT = 1e-9  # in xi; smaller changes of a slope are rounding


def cubic(travel: np.ndarray, values: np.ndarray, breaks: Sequence[int] = ()) -> np.ndarray:
    """Cubic spline (s-1,...,4) through ``values`` (s,...) at ``travel`` (s,) m: coefficients of the
    rising powers of the distance (m) from the station before. At the stations of these numbers
    (``breaks``, ascending) its slope may jump."""
    from scipy.interpolate import CubicSpline

    if not values.size:
        return np.zeros((len(travel) - 1, *values.shape[1:], 4))
    ends = [0, *breaks, len(travel) - 1]
    found = [
        CubicSpline(travel[first : last + 1], values[first : last + 1]).c[::-1]
        for first, last in itertools.pairwise(ends)
    ]
    return np.ascontiguousarray(np.moveaxis(np.concatenate(found, axis=1), 0, -1))


def breaks(part: np.ndarray) -> list[int]:
    """Numbers of the stations at which a face begins to leave the wall, or its part with a wall (s,f,2)
    begins to move or stops: slopes jump there. Between two stations a jump has no number."""
    jumps = (np.abs(np.diff(part, 2, axis=0)) > _STRAIGHT).any(axis=2)
    alone = jumps.copy()
    alone[1:] &= ~jumps[:-1]
    alone[:-1] &= ~jumps[1:]
    return (np.flatnonzero(alone.any(axis=1)) + 1).tolist()
