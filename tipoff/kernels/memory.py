"""Arrays that start on a cache line, so a vector of eight numbers is never in two lines."""

import math
from typing import Literal

import numpy as np

_CACHE_LINE = 64  # bytes


def zeros(shape: tuple[int, ...], order: Literal["C", "F"] = "C") -> np.ndarray:
    """Zeros (float64) of ``shape``."""
    size = 8 * math.prod(shape)
    space = np.zeros(size + _CACHE_LINE, dtype=np.uint8)
    # faster than ``ctypes.data``: a run of the surrogate makes two dozen of these
    start = -space.__array_interface__["data"][0] % _CACHE_LINE
    return space[start : start + size].view(np.float64).reshape(shape, order=order)


def aligned(array: np.ndarray) -> np.ndarray:
    """A copy (float64, in rows) that starts on a cache line."""
    copy = zeros(array.shape)
    copy[...] = array
    return copy
