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
    """The ``value`` that a ``share`` of the cases is below, and its two bounds; None where there is none."""

    share: float
    value: float | None
    low: float | None
    high: float | None


def quantiles(values: np.ndarray, shares: Sequence[float] = SHARES) -> list[dict]:
    """The quantile of each of ``shares`` with two-sided bounds; a bound is None where there are too
    few values (n,)."""
    found = zip(
        shares,
        np.quantile(values, shares),
        (order_statistics.bounds(values, share, CONFIDENCE) for share in shares),
    )
    return [
        {"share": share, "value": float(value), "low": low, "high": high}
        for share, value, (low, high) in found
    ]


def moments(values: np.ndarray) -> dict:
    """Mean, standard deviation, extremes, and the standard errors of the first two, of the values
    (n,); the error of the standard deviation is from the fourth moment."""
    count, mean, sd = values.size, float(values.mean()), float(values.std(ddof=1))
    fourth = float(((values - mean) ** 4).mean())
    error = math.sqrt(max(fourth - sd**4, 0.0) / count) / (2.0 * sd) if sd > 0.0 else 0.0
    return {
        "mean": mean,
        "mean_error": sd / math.sqrt(count),
        "sd": sd,
        "sd_error": error,
        "least": float(values.min()),
        "most": float(values.max()),
    }


def histograms(first: np.ndarray, values: np.ndarray) -> dict:
    """Densities of the ``first`` (m,) of the values and of all (n,), with common edges; zero
    without values."""
    low, high = np.quantile(values, (0.0005, 0.9995))
    edges = np.linspace(low, high if high > low else low + 1e-9, _BINS + 1)
    width = edges[1] - edges[0]
    densities = {
        name: (np.histogram(part, edges)[0] / (width * max(part.size, 1))).tolist()
        for name, part in (("first", first), ("all", values))
    }
    return {"edges": edges.tolist()} | densities


def convergence(values: np.ndarray, shares: Sequence[float]) -> list[dict]:
    """Quantiles with bounds of the first 100, 200, 500, 1000 ... cases and of all (n,). A case that
    did not settle, NaN, counts as a case; a part without settled cases is left out."""
    counts = [
        scale * 10**power
        for power in range(2, 10)
        for scale in (1, 2, 5)
        if scale * 10**power < values.size
    ] + [values.size]
    parts = [(count, part[np.isfinite(part)]) for count in counts for part in (values[:count],)]
    return [
        {"cases": count, **row}
        for count, part in parts
        if part.size
        for row in quantiles(part, shares)
    ]


def apart(one: Sequence[np.ndarray], other: Sequence[np.ndarray]) -> tuple[float, float]:
    """The largest distance of Kolmogorov and Smirnov between two independent samples over all
    quantities, and the probability of such a distance if the distributions are equal (times the
    number of quantities, after Bonferroni)."""
    tests = [ks_2samp(a, b, method="asymp") for a, b in zip(one, other, strict=True)]
    return max(float(test.statistic) for test in tests), min(
        1.0, len(tests) * min(float(test.pvalue) for test in tests)
    )
