"""The instant at which the last guide leaves the rail.

**By way**: the integral of the specific force less gravity reaches the travel of the scene. **By contact**: the
second differences of lateral accelerations and rates have one variance on the rail and a smaller one after it.
The instant is the mean of its posterior distribution for normal noise and a flat prior; with n_1 and n_2 samples
and sums of squares S_1 and S_2 of each signal,

    -ln p = 1/2 sum (n_1 ln(S_1 / n_1) + n_2 ln(S_2 / n_2)) + constant

Guides that slide quietly to the end leave no noise: contact then ends before the rail does.
"""

import numpy as np

from tipoff.scenes.scene import Scene

_SHARE = 1.0 / 3.0  # of the second differences that are independent
_FEWEST = 8  # samples on either side
_LOUDER = 2.0  # variance on the rail over that after it, of the signal where it is largest


def travel(scene: Scene) -> float:
    """Way (m) of the payload along the rail until the rear edge of its last pad leaves."""
    rear = min(pad.position[0] - 0.5 * pad.length for pad in scene.pads)
    return float(scene.rail.end - rear)


def by_way(time: np.ndarray, way: np.ndarray, length: float) -> float | None:
    """The first instant (s) at which the ``way`` (n,) m reaches ``length`` (m), by a straight line between
    samples; None if it does not."""
    over = np.flatnonzero((way >= length) & (time > 0.0))
    if not over.size:
        return None
    after = int(over[0])
    share = (length - way[after - 1]) / (way[after] - way[after - 1])
    return float(time[after - 1] + share * (time[after] - time[after - 1]))


def by_contact(
    time: np.ndarray, signals: np.ndarray, between: tuple[float, float]
) -> tuple[float, float] | None:
    """The instant (s) ``between`` two others at which the noise of ``signals`` (n,k) falls, and its standard
    uncertainty; None if it does not fall. The samples must begin on the rail."""
    rough = np.diff(signals, 2, axis=0) ** 2
    rough, time = rough[:, rough.sum(axis=0) > 0.0], time[1:-1]
    places = np.arange(_FEWEST, time.size - _FEWEST)
    places = places[(time[places] >= between[0]) & (time[places] <= between[1])]
    if not places.size or not rough.size:
        return None
    total = np.cumsum(rough, axis=0)
    before, count = total[places - 1], places[:, None].astype(float)
    after, rest = total[-1] - before, time.size - count
    with np.errstate(divide="ignore"):
        cost = 0.5 * (count * np.log(before / count) + rest * np.log(after / rest)).sum(axis=1)
    best = int(np.argmin(cost))
    if not ((before[best] / count[best]) > _LOUDER * (after[best] / rest[best])).any():
        return None
    chance = np.exp(-_SHARE * (cost - cost[best]))
    chance /= chance.sum()
    middle = float(chance @ time[places])
    spread = float(chance @ (time[places] - middle) ** 2)
    # the last jolt on the rail comes up to an interval before its end
    return middle, float(np.sqrt(spread + np.median(np.diff(time)) ** 2 / 12.0))
