"""End of a run of a scene: the time limit without a stated duration, the expected end, and the
earliest time at which rates can be settled.

A run ends once its rates have settled or the payload is jammed (``mechanics.outcome``). Without a
stated duration it ends at the latest at::

    end of thrust + way / v + jam + settled window

with v the slower one of two speeds: the friction transition speed, at least 10 mm/s, and the speed after
the thrust of a payload without friction. A weight along fixed rails that is too small for this speed
takes sqrt(2 way / g) from rest. The limit is rounded up to a power of two of 1 ms, so that variations of
a scene share one limit. Gravity that pulls a payload back on fixed rails ends its forward motion after
v_max / g, with v_max from the impulse alone.
"""

import math

import numpy as np

from tipoff.mechanics.estimates import pushed, stop
from tipoff.mechanics.estimates.launch import Launch
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.run_limits import (
    JAM_DURATION,
    LONGEST,
    MOST_SAMPLES,
    SETTLE_DELAY,
    SETTLE_WINDOW,
    SLOW,
)

_AFTER = 1e-3  # s, duration of a run after its end
_BURNT = 1e-3  # of the peak
_UNIT = 1e-3  # s
_MARGIN = 1.25  # of the expected end: friction delays the exit


def limit(launch: Launch) -> float:
    """Time (s) at which a run ends at the latest: its duration, or the bound of the module
    docstring, at most ``longest``."""
    if launch.duration is not None:
        return launch.duration
    record = launch.thrust
    slowest = max(SLOW, launch.slow)
    distance = max(launch.way, 0.0)
    coasting = distance / slowest
    if (pull := launch.pull) < 0.0:
        pushed_on = _pushed(_law(launch, launch.gain, 0.0))
        fastest = max(launch.begun, 0.0) + pushed_on / launch.mass
        coasting = min(coasting, 2.0 * fastest / -pull)
    else:
        own = _coasts_at(launch)
        alone = distance / own if own > _at_rest(launch) else 0.0
        if pull > 0.0:
            falling = math.sqrt(2.0 * distance / pull)
            alone = min(alone, falling) if alone else falling
        coasting = max(coasting, alone)
    # A payload that springs push is faster than this soon, or jammed.
    start = slides(launch, slowest) if launch.pushers is not None else 0.0
    end = (
        thrust_law.last(record)
        + start
        + coasting
        + JAM_DURATION
        + SETTLE_DELAY
        + SETTLE_WINDOW
        + _AFTER
    )
    rounded = _UNIT * 2.0 ** math.ceil(math.log2(end / _UNIT))
    return min(max(rounded, launch.interval), longest(launch.interval))


def longest(interval: float) -> float:
    """Longest run (s) without a stated duration: the one with the most samples, one in each ``interval``
    (s), at most an hour."""
    return min(MOST_SAMPLES * interval, LONGEST)


def settles_after(record: thrust_law.Thrust) -> float:
    """Time (s) until a thrust is over and rates settle, for a payload that has left its rail."""
    return _burnt(record) + SETTLE_WINDOW


def over_time(launch: Launch) -> thrust_law.Thrust:
    """The thrust over time. That of springs is an estimate, for a payload without friction on a
    platform that does not turn."""
    return _law(launch, launch.gain, launch.pull)


def _law(launch: Launch, gain: float, pull: float) -> thrust_law.Thrust:
    if launch.pushers is not None:
        curve = pushed.over_time(launch.pushers, gain, pull, launch.begun)
        return thrust_law.Thrust(pulses=None, curve=curve)
    return launch.thrust


def spring_impulses(launch: Launch) -> np.ndarray:
    """Estimate (n,) N s of the impulse of each of n springs, as ``over_time``."""
    assert launch.pushers is not None  # it has springs
    return pushed.impulses(launch.pushers, launch.gain, launch.pull, launch.begun)


def expected(launch: Launch) -> float:
    """Estimate (s) of the end of a run, for plots, progress and costs: the stated duration, or a
    payload without friction until it has settled, with a margin of a quarter."""
    if launch.duration is not None:
        return launch.duration
    record = over_time(launch)
    exits = _exit(launch, record, launch.gain, launch.pull, forwards=False)
    if not math.isfinite(exits):  # it falls back, or nothing moves it
        exits = thrust_law.last(record) + JAM_DURATION
    settled = max(exits + SETTLE_DELAY, _burnt(record)) + SETTLE_WINDOW
    return min(_MARGIN * settled, limit(launch))


def earliest(launch: Launch) -> float:
    """Lower bound (s) of the end of the settled window, infinite if the payload cannot leave in an
    hour: no friction, no thrust and no body force backwards, and a platform that recoils along the
    rail with all of its freedom. Zero if bodies turn at ignition, which moves the rail too."""
    force = launch.body_force
    gain, pull = _freest_gain(launch), max(force.x if force is not None else 0.0, 0.0)
    record = _law(launch, gain, pull)
    exits = 0.0 if launch.turns else _exit(launch, record, gain, pull, forwards=True)
    return max(exits + SETTLE_DELAY, _burnt(record)) + SETTLE_WINDOW


def exit_speed(launch: Launch) -> float | None:
    """Estimate (m/s) of the speed along the rail at the exit, of a payload without friction on a
    platform that does not turn; None if it never leaves."""
    record, gain, pull = over_time(launch), launch.gain, launch.pull
    left = _exit(launch, record, gain, pull, forwards=False)
    if not math.isfinite(left):
        return None
    held = stop.release_time(launch)
    pushed_on = thrust_law.impulse(record, left) - thrust_law.impulse(record, held)
    return launch.begun + gain * pushed_on + pull * (left - held)


def is_driven_otherwise(launch: Launch) -> bool:
    """Whether anything except the thrust moves the payload along the rail."""
    return launch.begun != 0.0 or launch.pull != 0.0


def speed_change(launch: Launch) -> float:
    """Change (m/s) of the speed along the rail by the whole thrust, on a platform that does not turn."""
    record = over_time(launch)
    return launch.gain * thrust_law.impulse(record, thrust_law.last(record))


def jam_speed(launch: Launch) -> float:
    """Relative axial speed (m/s) below which a payload counts as jammed (``mechanics.outcome``)."""
    force, pull, rests = launch.body_force, launch.pull, _at_rest(launch)
    if stop.release_time(launch) == math.inf:
        return rests
    if not launch.friction > 0.0:
        return rests if pull == 0.0 else 0.0
    if force is not None and pull < 0.0:  # friction of the weight holds it, or it slides back
        holds = launch.friction * math.hypot(force.y, force.z) >= -pull
        return launch.slow if holds else rests
    driven = pull > 0.0 or starts_briskly(launch, launch.slow)
    return launch.slow if driven or _coasts_at(launch) > launch.slow else rests


def _at_rest(launch: Launch) -> float:
    """Speed (m/s) of a payload that does not leave its rail in the longest run."""
    return min(launch.nominal_way / LONGEST, launch.slow)


def _coasts_at(launch: Launch) -> float:
    """Estimate (m/s) of the axial speed after the thrust of a payload without friction and body
    forces, on a platform that does not turn."""
    gain, begun = launch.gain, launch.begun
    if launch.pushers is not None:
        energy = max(0.0, pushed.energy(launch.pushers))
        return math.sqrt(max(begun, 0.0) ** 2 + 2.0 * gain * energy)
    return begun + gain * thrust_law.impulse(launch.thrust, math.inf)


def starts_briskly(launch: Launch, speed: float) -> bool:
    """Whether a constant thrust from ignition would bring a payload without friction to ``speed``
    (m/s) in half the duration of a jam; a payload that is slow then is held by friction."""
    return 0.5 * JAM_DURATION * launch.steady * launch.gain >= speed


def slides(launch: Launch, speed: float) -> float:
    """Time (s) in which a body force along fixed rails, and springs, bring a payload without
    friction from rest to twice this ``speed`` (m/s); zero without such a force."""
    pull = launch.pull
    if launch.pushers is not None:
        gain = launch.gain
        pull += gain * float(pushed.net_force(launch.pushers, np.zeros(1), gain, pull)[0])
    return 2.0 * speed / pull if pull > 0.0 and abs(launch.begun) < speed else 0.0


def _burnt(record: thrust_law.Thrust) -> float:
    """Time (s) after which the thrust is below 0.1 % of its peak."""
    return thrust_law.burnout(record, _BURNT, 2.0 * thrust_law.last(record) + _UNIT)


def _pushed(record: thrust_law.Thrust) -> float:
    """Impulse (N s) of the forward parts of the thrust."""
    time, force = thrust_law.forces(record)
    return float(np.trapezoid(np.maximum(force, 0.0), time))


def _exit(
    launch: Launch, record: thrust_law.Thrust, gain: float, pull: float, forwards: bool
) -> float:
    """Time (s) at which a payload without friction reaches the exit; infinite if it never does.
    ``gain`` is its acceleration relative to the rail per force (1/kg); with ``forwards`` only
    forward forces count."""
    time, force = thrust_law.forces(record)
    force = np.maximum(force, 0.0) if forwards else force
    begun = max(launch.begun, 0.0) if forwards else launch.begun
    distance = launch.way
    if distance <= 0.0:
        return 0.0
    free = time >= stop.release_time(launch)
    speed = begun + _integral((gain * force + pull) * free, time)
    place = _integral(speed, time)
    past = np.flatnonzero(place >= distance)
    if past.size:
        after = past[0]
        return float(np.interp(distance, place[after - 1 : after + 1], time[after - 1 : after + 1]))
    left, last = distance - float(place[-1]), float(speed[-1])
    if pull == 0.0:
        return float(time[-1]) + left / last if last > 0.0 else math.inf
    root = last * last + 2.0 * pull * left
    if root < 0.0 or (pull < 0.0 and last <= 0.0):
        return math.inf
    return float(time[-1]) + 2.0 * left / (last + math.sqrt(root))


def _integral(values: np.ndarray, time: np.ndarray) -> np.ndarray:
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(time)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _freest_gain(launch: Launch) -> float:
    """The largest gain: the platform turns too, about the axis of its smallest inertia."""
    if launch.platform_inertia is None:
        return launch.gain
    return launch.gain + launch.lever**2 / float(np.linalg.eigvalsh(launch.platform_inertia)[0])
