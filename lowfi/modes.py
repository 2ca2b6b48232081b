"""Number of vibrating modes of each rail in a run with ``modes="auto"``.

The first run has none. Its forces give the effect of each mode on the settled rates
(``lowfi.contact.compliant.neglected``). If the sum over the modes is above ``THRESHOLD``, the scene
is run again with the fewest lowest modes of each rail, at least ``FEWEST``, that bring the rest
below. The change of the rates between the two runs shows how much later contacts enlarge such a
sum; if the rest is above ``THRESHOLD`` with this factor, a third run has all modes. The last run is
the result, and ``cost`` has the sum of all.

The effects are always those of the first run. On a vibrating rail a contact breaks up into touches,
and a pad leaves each of them slowly: the estimate would be far too high.

The forces of a coarse integration excite modes that the contact does not, and its error appears as
a change of the rates. So if the first run, at a tolerance above the default, would choose modes, it
is repeated at the default; the choice then uses the repeated run. If that needs no modes, the first
run is the result.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from tipoff.lowfi.single_run import SingleRun

THRESHOLD = math.radians(0.02)  # rad/s, of the settled rates
FEWEST = 4  # if any are needed; the lowest modes of a rail come in pairs of like frequency


@dataclass(frozen=True)
class Choice:
    """A choice of modes."""

    modes: int  # vibrating modes of each rail
    why: str  # one line of text
    runs: "tuple[SingleRun, ...]" = ()  # made for the choice, without the result

    def cost(self) -> dict[str, int]:
        """``modes``, the number of runs without the result, and their steps."""
        steps = sum(int(run.loop.counts.steps) + run.discarded for run in self.runs)
        beside = {"auto_runs": len(self.runs), "auto_steps": steps} if self.runs else {}
        return {"modes": self.modes} | beside


def choose(
    run: "Callable[[int], SingleRun]", accurate: "Callable[[], SingleRun] | None" = None
) -> "tuple[SingleRun, Choice]":
    """The run with the necessary modes, and the choice. ``run`` makes a run with so many modes; one
    without modes watches all. ``accurate``, for a tolerance above the default, makes the run
    without modes at the default."""
    first = run(0)
    if first.message:
        return first, Choice(0, "none: the run without modes failed")
    every = [first]
    if accurate is not None and needed(first.neglected()):
        every.append(accurate())
    made = [every[-1] if not every[-1].message else first]
    effect, enlarged, failed = made[0].neglected(), 1.0, ""
    while needed(effect * enlarged) > made[-1].modes:
        fewest = min(max(needed(effect), FEWEST), effect.size)
        every.append(tried := run(fewest if len(made) == 1 else effect.size))
        if tried.message:  # the last completed run gives the result
            failed = f"a run with {tried.modes} failed: {tried.message}"
            break
        made.append(tried)
        enlarged = max(1.0, _enlarged(made[-2:], effect))
    result = first if len(made) == 1 else made[-1]
    why = f"{result.modes or 'none'}: {failed}" if failed else _why(made, effect, enlarged)
    return result, Choice(result.modes, why, tuple(each for each in every if each is not result))


def needed(effect: np.ndarray, threshold: float = THRESHOLD) -> int:
    """The fewest lowest modes for which the sum of the ``effect`` (n,) rad/s of the others is at
    most the ``threshold`` (rad/s)."""
    rest = np.append(np.cumsum(effect[::-1])[::-1], 0.0)
    return int(np.argmax(rest <= threshold))


def _enlarged(last: "list[SingleRun]", effect: np.ndarray) -> float:
    """Change of the settled rates from one run to the next, over the sum that predicted it."""
    before, after = (found.judged()[1].rate for found in last)
    if before is None or after is None:
        return 1.0
    stood = float(effect[last[0].modes : last[1].modes].sum())
    change = float(np.abs(np.subtract(after, before)).max())
    return change / stood if change > THRESHOLD else 1.0


def _why(made: "list[SingleRun]", effect: np.ndarray, enlarged: float) -> str:
    held = effect.size
    if held == 0:
        return "none: this rail compliance holds no modes"
    first = np.degrees(effect.sum())
    rest = np.degrees(effect[made[-1].modes :].sum() * enlarged)
    limit = f"{np.degrees(THRESHOLD):g} deg/s"
    if len(made) == 1:
        return (
            f"none: all {held} of each rail would move the settled rates by {first:.2g} deg/s, "
            f"below {limit}"
        )
    before, after = (found.judged()[1].rate for found in (made[0], made[-1]))
    moved = ""
    if before is not None and after is not None:
        change = np.degrees(np.abs(np.subtract(after, before)).max())
        moved = f"; they moved them by {change:.2g} deg/s"
    text = (
        f"{made[-1].modes} of {held} of each rail: without them the settled rates would move by "
        f"about {first:.2g} deg/s, above {limit}{moved}"
    )
    if made[-1].modes == held:
        return text + ". Higher modes are quasi-static"
    return text + f". The others would move them by {rest:.2g} deg/s"
