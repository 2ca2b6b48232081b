"""Bounds of quantiles from the order of independent draws, for any distribution.

The number of n draws below the quantile of probability p is binomial, so a pair of draws bounds the
quantile (``scipy.stats.quantile_test``). The largest of n draws is above it with
confidence ``1 - p^n``; the smallest and the largest enclose a share p of the distribution with
confidence ``1 - n p^(n-1) + (n-1) p^n`` (Wilks, Ann. Math. Statist. 12, 1941).
"""

import functools
import math

import numpy as np


def runs_needed(share: float, confidence: float = 0.95, sides: int = 1) -> int:
    """The smallest number of runs whose largest (``sides`` = 1), or smallest and largest (2), bound
    a ``share`` of all runs with this confidence."""

    def confident(n: int) -> bool:
        missed = share**n if sides == 1 else n * share ** (n - 1) - (n - 1) * share**n
        return 1.0 - missed >= confidence

    # for one side, at most one too small
    n = max(sides, math.floor(math.log(1.0 - confidence) / math.log(share)))
    while not confident(n):
        n += 1
    return n


def bounds(
    values: np.ndarray, share: float, confidence: float = 0.95
) -> tuple[float | None, float | None]:
    """Two-sided bounds of the quantile ``share`` from independent draws (n,); a bound is None if n
    is too small for it."""
    low, high = _places(len(values), share, confidence)
    ordered = np.sort(values)
    return (
        float(ordered[low]) if low >= 0 else None,
        float(ordered[high]) if high < len(ordered) else None,
    )


@functools.cache
def _places(count: int, share: float, confidence: float) -> tuple[int, int]:
    """Places of both bounds among ``count`` ordered draws; -1 and ``count`` for missing ones."""
    from scipy.stats import binom  # slow to load

    below, tail = binom(count, share), 0.5 * (1.0 - confidence)
    return int(below.ppf(tail)) - 1, int(below.isf(tail))
