"""The largest certified scale of a set of tolerances, with the same draws at every scale.

``above(s)`` counts the cases above a limit at scale s; s is certified if the count is at most
``allowed``. The search first tries all scales halved from ``most``, which shows whether the count
grows with the scale. It then bisects between the smallest scale that fails and the scale below it.
Certified scales beyond the first failure are reported and not used.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

FOUND, ALL, SMALL, NONE, LOST = "found", "all", "small", "none", "lost"
_HALVINGS, _REFINEMENTS = 7, 6  # down to 1/128, then to 1.1 %
_STEP, _CLOSER = 1.25, 3  # from a start near the result: factors of 1.25, then to 2.8 %


class Trial(NamedTuple):
    """A scale and its count."""

    scale: float
    above: int


class Found(NamedTuple):
    """``scale`` is the largest certified one below ``fails``, the first that fails. ``state``:
    FOUND; ALL, no searched scale fails; SMALL, all searched scales fail except zero; NONE, zero
    fails too; LOST, no search, because the model error exceeds a limit."""

    state: str
    scale: float | None
    fails: float | None
    trials: list[Trial]
    allowed: int

    @property
    def again(self) -> list[float]:
        """Certified scales beyond the first that fails."""
        return [
            trial.scale
            for trial in self.trials
            if self.fails is not None and trial.scale > self.fails and trial.above <= self.allowed
        ]

    @property
    def falls(self) -> list[tuple[float, float]]:
        """Neighbouring scales of which the larger has fewer cases above a limit."""
        return [
            (one.scale, two.scale)
            for one, two in zip(self.trials, self.trials[1:])
            if two.above < one.above
        ]


def largest(above: Callable[[float], int], allowed: int, most: float = 1.0) -> Found:
    """Search from ``most`` / 128 to ``most``."""
    counts = {
        scale: above(scale) for scale in (most * 0.5**power for power in range(_HALVINGS, -1, -1))
    }
    failing = [scale for scale, count in counts.items() if count > allowed]
    if not failing:
        return _found(ALL, most, None, counts, allowed)
    low, high = 0.5 * failing[0], failing[0]
    if low not in counts:
        counts[0.0] = above(0.0)
        return _found(NONE if counts[0.0] > allowed else SMALL, None, high, counts, allowed)
    return _found(
        FOUND, *_bisected(above, allowed, low, high, counts, _REFINEMENTS), counts, allowed
    )


def near(
    above: Callable[[float], int],
    allowed: int,
    start: float,
    most: float = 1.0,
    least: float = 0.5**_HALVINGS,
) -> Found:
    """Search outward from ``start``, the result of a similar search, within ``least`` to
    ``most``."""
    counts = {start: above(start)}
    up = counts[start] <= allowed
    while True:
        last = list(counts)[-1]
        if (counts[last] <= allowed) != up:
            break
        if up and last >= most:
            return _found(ALL, most, None, counts, allowed)
        if not up and last <= least:
            counts[0.0] = above(0.0)
            return _found(NONE if counts[0.0] > allowed else SMALL, None, last, counts, allowed)
        following = min(last * _STEP, most) if up else max(last / _STEP, least)
        counts[following] = above(following)
    low, high = sorted(list(counts)[-2:])
    return _found(FOUND, *_bisected(above, allowed, low, high, counts, _CLOSER), counts, allowed)


def _bisected(
    above, allowed: int, low: float, high: float, counts: dict[float, int], times: int
) -> tuple[float, float]:
    for _ in range(times):
        middle = math.sqrt(low * high)
        counts[middle] = above(middle)
        low, high = (middle, high) if counts[middle] <= allowed else (low, middle)
    return low, high


def _found(
    state: str, scale: float | None, fails: float | None, counts: dict[float, int], allowed: int
) -> Found:
    return Found(state, scale, fails, [Trial(*pair) for pair in sorted(counts.items())], allowed)
