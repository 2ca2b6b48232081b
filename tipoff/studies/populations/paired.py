"""Changes of statistics between two populations of the same draws, with bounds from the pairs.

Both values of a case depend on the same draws, so the chance in their statistics is nearly the same, and
that of the change is small. Bounds of the change of a quantile come from resampled cases, each with its
values of both populations (bootstrap, Efron 1979). The change of a share is (b - c)/n, where b cases show
the event in the second population alone, and c in the first alone; its bounds are those of Clopper and
Pearson of b/n and c/n, each at half the error probability (Bonferroni).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tipoff.comparison import order_statistics
from tipoff.studies.populations import exceedance

_RESAMPLES = 1000
_SEED = 1


@dataclass(frozen=True)
class Bounded:
    """A statistic, or its change, and its bounds; None for few or dependent cases."""

    value: float
    low: float | None
    high: float | None


def quantile_changes(
    first: np.ndarray, others: Sequence[np.ndarray], share: float, confidence: float
) -> list[Bounded]:
    """Change of the quantile ``share`` from ``first`` (n,) to each of ``others`` (n,), whose cases have the
    same draws. A case without a value (NaN) counts in no quantile of its population. Without bounds if
    the cases are too few to bound a quantile."""
    columns = [_Sorted(values) for values in (first, *others)]
    if any(None in order_statistics.bounds(each.values, share, confidence) for each in columns):
        start, *ends = (each.quantile(share) for each in columns)
        return [Bounded(end - start, None, None) for end in ends]
    generator, count = np.random.default_rng(_SEED), len(first)
    drawn = np.empty((_RESAMPLES, len(columns)))
    for row in drawn:
        times = np.bincount(generator.integers(count, size=count), minlength=count)
        row[:] = [each.resampled(share, times) for each in columns]
    tail = 0.5 * (1.0 - confidence)
    start, *ends = (each.quantile(share) for each in columns)
    return [
        Bounded(end - start, *map(float, np.quantile(changes, (tail, 1.0 - tail))))
        for end, changes in zip(ends, (drawn[:, 1:] - drawn[:, :1]).T)
    ]


class _Sorted:
    """Values (n,), sorted once for all of their resamples; NaN are left out."""

    def __init__(self, values: np.ndarray):
        order = np.argsort(values)  # NaN last
        self._order = order[: np.isfinite(values).sum()]
        self.values = values[self._order]

    def quantile(self, share: float) -> float:
        return float(np.quantile(self.values, share))

    def resampled(self, share: float, times: np.ndarray) -> float:
        """The quantile of the cases, each as many ``times`` (n,) as it was drawn."""
        passed = np.cumsum(times[self._order])
        return self.values[min(np.searchsorted(passed, share * passed[-1]), len(passed) - 1)]


def share_change(first: np.ndarray, second: np.ndarray, confidence: float) -> Bounded:
    """Change of the share of cases with an event; whether each case has it in the ``first`` and in the
    ``second`` population (n,)."""
    count = len(first)
    gained, lost = int((second & ~first).sum()), int((first & ~second).sum())
    each = 0.5 * (1.0 + confidence)
    up, down = (exceedance.bounds(number, count, each) for number in (gained, lost))
    return Bounded((gained - lost) / count, up[0] - down[1], up[1] - down[0])
