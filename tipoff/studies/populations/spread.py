"""Statistics of a quantity from independent cases: moments, quantiles with bounds, histograms, and
the convergence with the number of cases."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import ks_2samp

from tipoff.comparison import order_statistics

SHARES = (0.0027, 0.05, 0.5, 0.95, 0.99, 0.9973)
CONFIDENCE = 0.95
_BINS = 80


@dataclass(frozen=True)
class Quantile:
    """The ``value`` that a ``share`` of the cases is below, and its two bounds. A value is None if
    the event of its case does not occur; a bound is None for few or dependent cases."""

    share: float
    value: float | None
    low: float | None
    high: float | None


def quantiles(
    values: np.ndarray, shares: Sequence[float] = SHARES, bounded: bool = True
) -> tuple[Quantile, ...]:
    """The quantile of values (n,) for each of ``shares``, with its bounds if ``bounded``."""

    def bounds(share: float) -> tuple[float | None, float | None]:
        return order_statistics.bounds(values, share, CONFIDENCE) if bounded else (None, None)

    return tuple(
        Quantile(share, float(value), *bounds(share))
        for share, value in zip(shares, np.quantile(values, shares))
    )


@dataclass(frozen=True, kw_only=True)
class Moments:
    """Mean, standard deviation, their standard errors, and extremes."""

    mean: float
    mean_error: float
    sd: float
    sd_error: float
    least: float
    most: float


def moments(values: np.ndarray) -> Moments:
    """Moments of the values (n,); the error of the standard deviation is from the fourth moment."""
    count, mean, sd = values.size, float(values.mean()), float(values.std(ddof=1))
    fourth = float(((values - mean) ** 4).mean())
    error = math.sqrt(max(fourth - sd**4, 0.0) / count) / (2.0 * sd) if sd > 0.0 else 0.0
    return Moments(
        mean=mean,
        mean_error=sd / math.sqrt(count),
        sd=sd,
        sd_error=error,
        least=float(values.min()),
        most=float(values.max()),
    )


@dataclass(frozen=True)
class Histogram:
    """Densities between common ``edges``."""

    edges: tuple[float, ...]
    first: tuple[float, ...]
    all: tuple[float, ...]


def histograms(first: np.ndarray, values: np.ndarray) -> Histogram:
    """Densities of the ``first`` (m,) of the values and of all (n,); zero without values."""
    low, high = np.quantile(values, (0.0005, 0.9995))
    edges = np.linspace(low, high if high > low else low + 1e-9, _BINS + 1)
    width = edges[1] - edges[0]
    densities = (
        tuple((np.histogram(part, edges)[0] / (width * max(part.size, 1))).tolist())
        for part in (first, values)
    )
    return Histogram(tuple(edges.tolist()), *densities)


def convergence(values: np.ndarray, shares: Sequence[float]) -> list[tuple[int, Quantile]]:
    """Quantiles of the first 100, 200, 500, 1000 ... cases and of all (n,), each with the number of
    cases. A case that did not settle (NaN) counts; a part without settled cases is left out."""
    counts = [
        scale * 10**power
        for power in range(2, 10)
        for scale in (1, 2, 5)
        if scale * 10**power < values.size
    ] + [values.size]
    parts = [(count, part[np.isfinite(part)]) for count in counts for part in (values[:count],)]
    return [
        (count, quantile)
        for count, part in parts
        if part.size
        for quantile in quantiles(part, shares)
    ]


def apart(one: Sequence[np.ndarray], other: Sequence[np.ndarray]) -> tuple[float, float]:
    """The largest distance of Kolmogorov and Smirnov between two independent samples over all
    quantities, and the probability of such a distance if the distributions are equal (times the
    number of quantities, after Bonferroni)."""
    tests = [ks_2samp(a, b, method="asymp") for a, b in zip(one, other, strict=True)]
    return max(float(test.statistic) for test in tests), min(
        1.0, len(tests) * min(float(test.pvalue) for test in tests)
    )
