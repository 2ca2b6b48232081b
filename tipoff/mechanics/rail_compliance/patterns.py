"""Patterns of pressure and displacement on a pad face: phi_a = xi^i eta^j up to a degree i + j.

The order is that of the degree, then of j, so that the patterns of a lower degree come first: 1, xi,
eta, xi^2, xi eta, eta^2 for the second.
"""

import math
from functools import cache

import numpy as np

DEGREE = 3  # by default
LOW_DEGREE = 2  # of a case of many, and the least of a compliance
LEAST_DEGREE, MOST_DEGREE = 1, 5  # a sixth brings the surrogate no nearer to the reference
DRAGGED = 3  # patterns of the traction of friction
FARTHEST = 2.0  # in xi, of the middle of the part of a face with a wall; a face that has left presses no more


def count(degree: int = DEGREE) -> int:
    """Number of patterns p."""
    return (degree + 1) * (degree + 2) // 2


def degree_of(patterns: int) -> int:
    """Degree of so many ``patterns``. Raises ValueError for a number that no degree has."""
    for degree in range(LEAST_DEGREE, MOST_DEGREE + 1):
        if count(degree) == patterns:
            return degree
    allowed = ", ".join(str(count(each)) for each in range(LEAST_DEGREE, MOST_DEGREE + 1))
    raise ValueError(f"patterns: given {patterns}, expected one of {allowed}")


@cache
def powers(degree: int = DEGREE) -> np.ndarray:
    """Powers (p,2) of xi and eta."""
    found = np.array([[n - j, j] for n in range(degree + 1) for j in range(n + 1)])
    found.flags.writeable = False
    return found


@cache
def gram(degree: int = DEGREE) -> np.ndarray:
    """Means (p,p) over a face of products of two patterns: the mean of xi^n is 1 / (n + 1) for even
    n."""
    together = powers(degree)[:, None] + powers(degree)
    even = (together % 2 == 0).all(axis=2)
    found = np.where(even, 1.0 / (together + 1.0).prod(axis=2), 0.0)
    found.flags.writeable = False
    return found


def on_part(part: np.ndarray, degree: int = DEGREE) -> np.ndarray:
    """Coefficients (...,p,p) by which patterns of a whole face are sums of those of a ``part``
    (...,2) of it, its middle and half length in xi, by the binomial theorem."""
    middle, half = part[..., 0], part[..., 1]
    found = np.zeros((*middle.shape, count(degree), count(degree)))
    for row, (power, across) in enumerate(powers(degree).tolist()):
        for lower in range(power + 1):
            column = (lower + across) * (lower + across + 1) // 2 + across
            ways = math.comb(power, lower)
            found[..., row, column] = ways * middle ** (power - lower) * half**lower
    return found


PATTERNS = count()  # of the default degree
