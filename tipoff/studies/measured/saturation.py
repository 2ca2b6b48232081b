"""Finds samples at which a sensor or its logger is saturated. A saturated channel repeats its largest
value. Noise that is added after the clipping changes it by a step or two of the resolution.

The level can differ from the range: offsets, calibration and the logger move it, on both sides by
different amounts. Three tests decide whether the samples at the largest level, the top, are saturated:

* Does the signal have a corner there? At a smooth maximum the number of samples within k widths of the
  level grows with sqrt(k), so twice as many samples lie just below the level, within eight widths, as at
  it. A clipped signal has few samples just below.
* Is the level near the range? Then three samples in a row are enough.
* Far from the range: can the level be chance? If the share p of samples equals the sample before, a run
  of L equal samples among the k at the top has the probability k p^(L-1). A quiet sensor, whose noise is
  below its resolution, may stay at one value. A vibration may be clipped for one or two samples of each
  cycle; then many samples are equal to the largest, and very few are just below.

Samples that differ by a step or two count as one level only within a tenth of the range. Far from the
range, a settled rate with less noise than before looks the same.
"""

import numpy as np

from tipoff.studies.measured.quantisation import steps

_AT = 1e-3  # of the range: a low-pass after the clipping may reduce the level by this
_NEAR, _NEAR_NOISY, _RUN = 0.02, 0.005, 3  # shares of the range, and samples in a row there
_LIKELY = 0.1  # share of the range within which a level with noise is searched
_NOISY = (2.5, 4.5)  # steps between the smallest and the largest sample of a level with noise on it
_LEAST, _CHANCE = (
    4,
    1e-6,
)  # equal samples far from the range, and how many such runs chance may give
_MANY, _RARE = 8, 8  # equal largest samples, and how many of them for each just below
_CORNER = 0.5  # samples just below a level for each at it; a smooth maximum has more
_BELOW = 8.0  # widths of a level, or steps, that are just below it
_QUIET = 1.5  # steps between samples of a sensor that may stay at one value
_EQUAL = 1e-6  # relative: a value in single precision, or converted from another unit


def saturated(
    values: np.ndarray, largest: float, step: float | np.ndarray | None = None
) -> np.ndarray:
    """Samples (n,k) of ``values`` (n,k) of a sensor with the range ``largest`` that are saturated;
    ``step`` () or (k,) is that of the sensor, all in one unit. Without it ``values`` show the step."""
    found = np.abs(values) >= largest * (1.0 - _AT)
    sizes = np.broadcast_to(steps(values) if step is None else step, values.shape[1])
    for axis, (column, size) in enumerate(zip(values.T, sizes.tolist())):
        for sign in (1.0, -1.0):
            found[:, axis] |= _plateau(sign * column, largest, size)
    return found


def _plateau(column: np.ndarray, largest: float, step: float) -> np.ndarray:
    """Where (n,) a column (n,) is at its maximum, if that is a level of saturation."""
    level = np.nanmax(column, initial=-np.inf)
    equal = _EQUAL * abs(level)
    same, step = max(0.5 * step, equal), max(step, equal)
    for width in (same, *(factor * step for factor in _NOISY)):
        top = column >= level - width
        is_noisy = width > same
        if _has_corner(column, level, top, max(width, step)) and (
            _is_near(level, largest, top, is_noisy)
            or _is_no_chance(
                column, top, step, width, is_noisy and level < (1.0 - _LIKELY) * largest
            )
        ):
            return top
    return np.zeros(column.size, dtype=bool)


def _has_corner(column: np.ndarray, level: float, top: np.ndarray, width: float) -> bool:
    """Whether few samples are just below a level beside those at it."""
    just_below = ~top & (column >= level - (1.0 + _BELOW) * width)
    return bool(just_below.sum() < _CORNER * top.sum())


def _is_near(level: float, largest: float, top: np.ndarray, is_noisy: bool) -> bool:
    near = _NEAR_NOISY if is_noisy else _NEAR
    return bool(level >= largest * (1.0 - near) and _longest(top) >= _RUN)


def _is_no_chance(
    column: np.ndarray, top: np.ndarray, step: float, width: float, is_far: bool
) -> bool:
    """Whether more samples, or more in a row, are at the level than by chance."""
    others, count = np.abs(np.diff(column[~top])), int(top.sum())
    if is_far or not others.size or np.median(others) <= _QUIET * step:
        return False
    share = max(float((others <= width).mean()), 1.0 / others.size)
    longest = _longest(top)
    if longest >= _LEAST and count * share ** (longest - 1.0) < _CHANCE:
        return True
    level = column[top].min()
    just_below = ~top & (column >= level - _BELOW * max(width, step))
    return bool(count >= _MANY and _RARE * just_below.sum() <= count)


def _longest(flags: np.ndarray) -> int:
    """Length of the longest stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return int((edges[1::2] - edges[::2]).max(initial=0))
