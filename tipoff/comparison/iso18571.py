"""Objective rating of two curves by ISO/TS 18571, developed for crash tests.

    R = 0.4 Z + 0.2 E_P + 0.2 E_M + 0.2 E_S          1 is a perfect match, above 0.94 "excellent", below 0.58 "poor"

* corridor Z: mean over time of 1 inside 5 % of the reference's largest amplitude, 0 beyond 50 %,
  squared ramp between;
* phase E_P: falls linearly with the shift of the best cross-correlation, 0 at 20 % of the length;
* magnitude E_M: after that shift and dynamic time warping (band 10 %), falls with the relative L1
  difference, 0 at 0.5;
* slope E_S: after that shift, the same of the derivatives smoothed over nine samples, 0 at 2.

Source: ISO/TS 18571:2014, sections 6.2 to 6.6.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import njit

_INNER, _OUTER, _CORRIDOR_EXPONENT = 0.05, 0.5, 2.0
_LARGEST_SHIFT, _LARGEST_MAGNITUDE_ERROR, _LARGEST_SLOPE_ERROR = 0.2, 0.5, 2.0
_WARPING_BAND = 0.1
_SMOOTHING = (1, 3, 5, 7, 9)  # samples averaged, from the ends to the inside


class Rating(NamedTuple):
    """Overall rating and its four parts, all in 0..1."""

    overall: float
    corridor: float
    phase: float
    magnitude: float
    slope: float


def rate(reference: np.ndarray, curve: np.ndarray) -> Rating:
    """Rating of ``curve`` (n,) against ``reference`` (n,), both sampled at the same equidistant
    times, n >= 20.

    Raises ValueError for curves of different or too small length. For a reference of zeros the
    rating is 1 if the curve is zero too, else 0.
    """
    reference, curve = np.asarray(reference, dtype=float), np.asarray(curve, dtype=float)
    if reference.shape != curve.shape or reference.ndim != 1 or reference.size < 20:
        raise ValueError(
            f"two curves of one length, at least 20 samples; given {reference.shape} and "
            f"{curve.shape}"
        )
    if not reference.any():
        return Rating(*(float(not curve.any()),) * 5)
    shift = best_shift(reference, curve)
    moved_reference, moved_curve = _overlap(reference, curve, shift)
    corridor = _corridor(reference, curve)
    phase = max(0.0, 1.0 - abs(shift) / (_LARGEST_SHIFT * reference.size))
    magnitude = _falling(_warped_difference(moved_reference, moved_curve), _LARGEST_MAGNITUDE_ERROR)
    slope = _falling(
        _relative_l1(_slope(moved_reference), _slope(moved_curve)), _LARGEST_SLOPE_ERROR
    )
    overall = 0.4 * corridor + 0.2 * (phase + magnitude + slope)
    return Rating(overall, corridor, phase, magnitude, slope)


def best_shift(reference: np.ndarray, curve: np.ndarray) -> int:
    """Samples by which ``curve`` lags the reference (positive: late) at the largest normalised
    cross-correlation."""
    limit = math.floor(_LARGEST_SHIFT * reference.size)
    # of equal correlations the smallest shift is taken
    shifts = sorted(range(-limit, limit + 1), key=abs)
    return max(shifts, key=lambda shift: _correlation(*_overlap(reference, curve, shift)))


def _overlap(reference, curve, shift):
    if shift >= 0:
        return reference[: reference.size - shift], curve[shift:]
    return reference[-shift:], curve[: curve.size + shift]


def _correlation(a, b) -> float:
    scale = math.sqrt(float(a @ a) * float(b @ b))
    # Rounded, so that rounding errors cannot prefer a shift of a periodic curve.
    return round(float(a @ b) / scale, 12) if scale > 0.0 else 0.0


def _corridor(reference, curve) -> float:
    size = np.abs(reference).max()
    ramp = (_OUTER * size - np.abs(curve - reference)) / ((_OUTER - _INNER) * size)
    return float(np.mean(np.clip(ramp, 0.0, 1.0) ** _CORRIDOR_EXPONENT))


def _falling(error: float, largest: float) -> float:
    return max(0.0, 1.0 - error / largest)


def _relative_l1(reference, curve) -> float:
    scale = np.abs(reference).sum()
    difference = np.abs(curve - reference).sum()
    return float(difference / scale) if scale > 0.0 else (math.inf if difference > 0.0 else 0.0)


def _slope(values: np.ndarray) -> np.ndarray:
    """Central differences, then a moving mean over nine samples that narrows towards the ends."""
    gradient = np.gradient(values)
    smooth = gradient.copy()
    for margin, width in enumerate(_SMOOTHING[:-1]):
        smooth[margin], smooth[-margin - 1] = gradient[:width].mean(), gradient[-width:].mean()
    inner = len(_SMOOTHING) - 1
    smooth[inner:-inner] = np.convolve(
        gradient, np.full(_SMOOTHING[-1], 1.0 / _SMOOTHING[-1]), mode="valid"
    )
    return smooth


def _warped_difference(reference, curve) -> float:
    band = max(1, math.ceil(_WARPING_BAND * reference.size))
    difference, scale = _along_warping_path(
        np.ascontiguousarray(reference), np.ascontiguousarray(curve), band
    )
    return difference / scale if scale > 0.0 else 0.0


@njit
def _along_warping_path(reference, curve, band):
    """L1 norms of the difference and of the reference along the path of least squared distance
    within ``band`` samples."""
    n = reference.size
    cost = np.full((n + 1, n + 1), np.inf)
    cost[0, 0] = 0.0
    for i in range(1, n + 1):
        for j in range(max(1, i - band + 1), min(n, i + band - 1) + 1):
            step = min(cost[i - 1, j - 1], min(cost[i - 1, j], cost[i, j - 1]))
            cost[i, j] = step + (reference[i - 1] - curve[j - 1]) ** 2
    difference, scale = 0.0, 0.0
    i, j = n, n
    while i > 0 and j > 0:
        difference += abs(reference[i - 1] - curve[j - 1])
        scale += abs(reference[i - 1])
        diagonal, up, left = cost[i - 1, j - 1], cost[i - 1, j], cost[i, j - 1]
        if diagonal <= up and diagonal <= left:
            i, j = i - 1, j - 1
        elif up <= left:
            i -= 1
        else:
            j -= 1
    return difference, scale
