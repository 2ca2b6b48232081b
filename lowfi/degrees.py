"""Degree of the patterns on a pad face in a run with ``degree="auto"``.

It is the least one, from the second on, whose next degree changes no settled rate by more than
``modes.THRESHOLD``, in runs without modes of the rails. The number of modes is chosen afterwards.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from tipoff.lowfi.modes import THRESHOLD
from tipoff.mechanics.rail_compliance import DEGREE, LOW_DEGREE

if TYPE_CHECKING:
    from tipoff.lowfi.single_run import SingleRun


def choose(run: "Callable[[int], SingleRun]", most: int) -> tuple[int, str]:
    """The degree, up to ``most``, and the reason in one line of text; ``run`` makes a run with
    patterns of a degree."""
    degree, change = min(LOW_DEGREE, most), 0.0
    rate = _settled(run(degree))
    while degree < most:
        following = _settled(run(degree + 1))
        if rate is None or following is None:
            which, usual = degree if rate is None else degree + 1, min(DEGREE, most)
            return usual, f"{usual}: a run with patterns of degree {which} did not settle"
        change, rate = float(np.abs(following - rate).max()), following
        if change <= THRESHOLD:
            moved = f"degree {degree + 1} would move the settled rates by"
            return degree, f"{degree}: {moved} {np.degrees(change):.2g} deg/s, {_limit()}"
        degree += 1
    if most <= LOW_DEGREE:
        return most, f"{most}: this rail compliance has no higher one"
    moved = f"it moved the settled rates by {np.degrees(change):.2g} deg/s"
    return most, f"{most}: {moved}, and there is no higher one"


def _settled(run: "SingleRun") -> np.ndarray | None:
    """Settled rates (3,) rad/s, None without."""
    rate = None if run.message else run.judged()[1].rate
    return None if rate is None else np.array(rate)


def _limit() -> str:
    return f"below {np.degrees(THRESHOLD):g} deg/s"
