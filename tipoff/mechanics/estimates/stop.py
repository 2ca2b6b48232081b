"""Stop behind a payload that rests on fixed rails: it pushes forwards, and does not pull.

A weight that pulls the payload back along the rail presses it on the stop. The payload leaves its stop
when the thrust along the rail exceeds this weight::

    F cos a > m |g_x|,     a: misalignment of the thrust

It may come back at once, as under the spike of an igniter. Such a hop of less than ``HOP``, of a payload
without friction, is left out: the payload rests on its stop until it leaves for good. On a free
platform, payload and platform fall alike, so nothing presses the payload on a stop.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from tipoff.mechanics.estimates import pushed
from tipoff.mechanics.laws import thrust as thrust_law

if TYPE_CHECKING:
    from tipoff.mechanics.estimates.launch import Launch

HOP = 1e-4  # m


def is_there(launch: "Launch") -> bool:
    """Whether the payload rests on a stop at ignition."""
    return launch.pull < 0.0 and launch.rests


def weight(launch: "Launch") -> float:
    """Force (N) of the body forces on the payload, back along fixed rails."""
    return -launch.mass * launch.pull


def release_time(launch: "Launch") -> float:
    """Time (s) at which neither a latch nor a stop holds the payload any more; infinite if the thrust is
    too small."""
    latched = launch.latched
    if latched == math.inf or not is_there(launch):
        return latched
    pull, gain = launch.pull, 1.0 / launch.mass
    if launch.pushers is not None:
        push = pushed.net_force(launch.pushers, np.zeros(1), gain, pull)
        return 0.0 if gain * float(push[0]) + pull > 0.0 else math.inf
    along = gain * launch.along
    return _left(launch.thrust, along, pull, latched) if along > 0.0 else math.inf


def _left(thrust: thrust_law.Thrust, gain: float, pull: float, latched: float) -> float:
    """Time (s) from ``latched`` on, for the acceleration (1/kg) per thrust and that of the weight
    (m/s2)."""
    time, force = thrust_law.forces(thrust)
    net = gain * force + pull
    start = int(np.searchsorted(time, latched))
    while start < time.size:
        lifted = np.flatnonzero(net[start:] > 0.0)
        if not lifted.size:
            break
        first = start + int(lifted[0])
        steps = np.diff(time[first:])
        speed = np.append(0.0, np.cumsum(0.5 * (net[first + 1 :] + net[first:-1]) * steps))
        place = np.append(0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]) * steps))
        back = np.flatnonzero(place < 0.0)
        if not back.size or place[: back[0]].max() > HOP:
            before = time[max(first - 1, 0)]
            at = thrust_law.crossing(thrust, -pull / gain, float(time[first]), float(before))
            return max(latched, at)
        start = first + int(back[0])
    return math.inf
