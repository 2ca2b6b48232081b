"""Where a sensor or its logger is saturated. A saturated channel repeats its largest value.

A run of L equal extreme samples is no saturation if the sensor often repeats a value by chance. Of n
samples, of which the share p equals the one before, n p^(L-1) such runs are expected. So a quiet
sensor, whose noise is below its resolution, may repeat its extreme value; within ``_NEAR`` of the
range it may not. The level need not be the range: offsets, calibration and the logger move it, and
not by the same amount on both sides.
"""

import numpy as np

_AT = 1e-3  # of the range: what a low-pass after the clipping leaves below it
_NEAR, _RUN = 0.02, 3  # of the range, and equal samples there
_LEAST, _CHANCE = 4, 1e-6  # equal samples elsewhere, and how many such runs chance may give
_QUIET = 1.5  # steps between samples of a sensor that may rest at one value
_EQUAL = 1e-6  # relative: a value in single precision, or converted from another unit


def saturated(values: np.ndarray, largest: float, resolution: float = 0.0) -> np.ndarray:
    """Samples (n,k) of ``values`` (n,k) of a sensor with the range ``largest`` that are saturated;
    ``resolution`` is the step of the sensor, all in one unit."""
    found = np.abs(values) >= largest * (1.0 - _AT)
    for axis, column in enumerate(values.T):
        for sign in (1.0, -1.0):
            found[:, axis] |= _plateau(sign * column, largest, resolution)
    return found


def _plateau(column: np.ndarray, largest: float, resolution: float) -> np.ndarray:
    """Where (n,) a column (n,) is at its maximum, if that is a level of saturation."""
    level = np.nanmax(column, initial=-np.inf)
    same = max(0.5 * resolution, _EQUAL * abs(level))
    top = column >= level - same
    longest = _longest(top)
    near = level >= largest * (1.0 - _NEAR)
    if near and longest >= _RUN:
        return top
    others = np.abs(np.diff(column[~top]))
    if longest < _LEAST or not others.size:
        return np.zeros_like(top)
    step = max(resolution, others[others > 0.0].min(initial=np.inf))
    if np.median(others) <= _QUIET * step:
        return np.zeros_like(top)
    share = max(float((others <= same).mean()), 1.0 / others.size)
    by_chance = column.size * share ** (longest - 1.0)
    return top if by_chance < _CHANCE else np.zeros_like(top)


def _longest(flags: np.ndarray) -> int:
    """Length of the longest stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return int((edges[1::2] - edges[::2]).max(initial=0))
