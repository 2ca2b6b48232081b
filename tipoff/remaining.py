"""Time left of long work, from the speed of its last minute."""

import math

_SPAN = 60.0  # s, over which the speed is measured
_APART = 1.0  # s, between two entries
_LEAST = 0.02  # share done from which the time left is stated
_WRONG = 2  # estimates that were too short, from which that is said


class Remaining:
    """Estimates for work of which a ``share`` is done at the time ``now`` (s)."""

    def __init__(self, now: float, share: float = 0.0):
        self._seen = [(now, share)]  # time (s) and share done, ascending
        self._promised = math.inf  # s, the end by the last estimate
        self._wrong = 0  # estimates whose end has passed

    def note(self, now: float, share: float) -> None:
        """The ``share`` (0 to 1) that is done ``now`` (s). A smaller one begins a new scale."""
        if share < self._seen[-1][1]:
            self._seen, self._promised = [(now, share)], math.inf
        elif len(self._seen) > 1 and now - self._seen[-2][0] < _APART:
            self._seen[-1] = now, share
        else:
            self._seen.append((now, share))
        while len(self._seen) > 2 and self._seen[1][0] <= now - _SPAN:
            del self._seen[0]

    def seconds(self, now: float) -> float | None:
        """Time (s) left; None if it is not known, as without progress in the last minute."""
        (began, before), (_, share) = self._seen[0], self._seen[-1]
        if not (_LEAST < share < 1.0 and share > before and now > began):
            return None
        return (1.0 - share) * (now - began) / (share - before)

    def words(self, now: float) -> str:
        """The time left as text, which says if earlier ones were too short; empty if not known."""
        if now > self._promised:
            self._wrong, self._promised = self._wrong + 1, math.inf
        left = self.seconds(now)
        if left is None:
            return ""
        self._promised = now + left
        late = "; earlier estimates were too short" if self._wrong >= _WRONG else ""
        return f"{duration(left)} left{late}"


def duration(seconds: float) -> str:
    """A time (s) as text."""
    return f"{seconds:.0f} s" if seconds < 90.0 else f"{seconds / 60.0:.0f} min"
