"""Stop behind a payload that rests on fixed rails: it pushes forwards, and does not pull.

A weight that pulls the payload back along the rail presses it on the stop. The payload leaves its stop
when the thrust along the rail exceeds this weight::

    F cos a > m |g_x|,     a: misalignment of the thrust

It may come back at once, as under the spike of an igniter. Such a hop of less than ``HOP``, of a payload
without friction, is left out: the payload rests on its stop until it leaves for good. On a free
platform, payload and platform fall alike, so nothing presses the payload on a stop.
"""

import math

import numpy as np

from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.scenes import pushed
from tipoff.scenes.effects import hold_down, registry, thrust_offset
from tipoff.scenes.effects.spring import PushedTable

HOP = 1e-4  # m


def is_there(scene) -> bool:
    """Whether the payload of ``scene`` rests on a stop at ignition. A latch that opens at ignition,
    ``hold_down.release`` of zero, takes the stop away."""
    first, latch = scene.initial, scene.hold_down
    rests = first is None or first.velocity.x == 0.0
    return _pull(scene) < 0.0 and rests and (latch is None or latch.release > 0.0)


def _pull(scene) -> float:
    """Acceleration (m/s2) of the payload along fixed rails by the body forces; zero on a free platform."""
    force = registry.body_force(scene)
    return force.x if force is not None and scene.platform is None else 0.0


def weight(scene) -> float:
    """Force (N) of the body forces on the payload, back along fixed rails."""
    return -scene.payload.mass * _pull(scene)


def record(scene) -> HoldDown | None:
    """Kernel record of latch and stop, None if nothing is held after the ignition. Raises SceneError as
    ``hold_down.require``."""
    hold_down.require(scene)
    time, latched = release_time(scene), hold_down.release_time(scene)
    centre = scene.platform.mass_centre if scene.platform is not None else None
    line = (0.0, 0.0) if centre is None else (-centre.y, -centre.z)
    return HoldDown(time, line, time > latched) if time > 0.0 else None


def release_time(scene) -> float:
    """Time (s) at which neither a latch nor a stop holds the payload any more; infinite if the thrust is
    too small."""
    latched = hold_down.release_time(scene)
    if latched == math.inf or not is_there(scene):
        return latched
    pull, gain = _pull(scene), 1.0 / scene.payload.mass
    if isinstance(scene.thrust, PushedTable):
        push = pushed.net_force(scene.thrust, np.zeros(1), gain, pull)
        return 0.0 if gain * float(push[0]) + pull > 0.0 else math.inf
    line = thrust_offset.record(scene.thrust_offset, scene.mass_offset, scene.thrust.arm)
    along = gain * (line.direction[0] if line is not None else 1.0)
    return _left(scene.thrust.record(), along, pull, latched) if along > 0.0 else math.inf


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
