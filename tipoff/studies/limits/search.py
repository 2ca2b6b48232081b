"""The largest certified tolerance, as a scale of a set of tolerances, with the same draws at every scale.

``above(s)`` counts the cases above a limit at scale s; s is certified if the count is at most
``allowed``. The search first tries all scales halved from ``most``, which shows whether the count
grows with the scale. It then bisects between the smallest scale that fails and the scale below it.
Certified scales beyond the first failure are reported and not used.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

FOUND, ALL, SMALL, NONE, LOST = "found", "all", "small", "none", "lost"
_HALVINGS, _REFINEMENTS = 7, 6  # down to 1/128, then to 1.1 %
_STEP, _CLOSER = 1.25, 3  # from a start near the result: factors of 1.25, then to 2.8 %


class Trial(NamedTuple):
    """A tolerance and its number of cases above a limit."""

    tolerance: float
    above: int


@dataclass(frozen=True)
class Found:
    """``tolerance`` is the largest certified one below ``fails``, the first that fails. ``state``:
    FOUND; ALL, none of the ``trials`` fails; SMALL, all fail except zero; NONE, zero fails too;
    LOST, no search, because the model error exceeds a limit."""

    state: str
    tolerance: float | None = None
    fails: float | None = None
    again: tuple[float, ...] = ()  # certified beyond the first that fails
    # neighbouring trials of which the larger has fewer cases above a limit
    falls: tuple[tuple[float, float], ...] = ()
    trials: tuple[Trial, ...] = ()

    def times(self, size: float) -> "Found":
        """The same in another unit, in which scale one is ``size``."""
        return Found(
            self.state,
            None if self.tolerance is None else size * self.tolerance,
            fails=None if self.fails is None else size * self.fails,
            again=tuple(size * scale for scale in self.again),
            falls=tuple((size * one, size * two) for one, two in self.falls),
            trials=tuple(Trial(size * trial.tolerance, trial.above) for trial in self.trials),
        )


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
    trials = tuple(Trial(*pair) for pair in sorted(counts.items()))
    fine = (trial.tolerance for trial in trials if trial.above <= allowed)
    falls = (
        (one.tolerance, two.tolerance)
        for one, two in itertools.pairwise(trials)
        if two.above < one.above
    )
    again = tuple(each for each in fine if fails is not None and each > fails)
    return Found(state, scale, fails=fails, again=again, falls=tuple(falls), trials=trials)
