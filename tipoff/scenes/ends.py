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
from types import SimpleNamespace
from typing import Any

import numpy as np

from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes import pushed, stop
from tipoff.scenes.body import tensor
from tipoff.scenes.effects import registry
from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.faults import within
from tipoff.scenes.rounding import apart, at_most, below
from tipoff.scenes.tables import MOST_SAMPLES, OutputTable
from tipoff.scenes.travel import ends_behind_the_pads, nominal_way, strokes_too_long
from tipoff.scenes.travel import way as way
from tipoff.scenes.units import LONGEST

EXIT_WINDOW = 2e-4  # s, from the exit on
SETTLE_DELAY = 1e-3  # s, from the exit to the settled window
SETTLE_WINDOW = 2e-3  # s
JAM_DURATION = 5e-3  # s
_SLOW = 0.01  # m/s, where friction has no transition speed
_AFTER = 1e-3  # s, duration of a run after its end
_BURNT = 1e-3  # of the peak
_UNIT = 1e-3  # s
_MARGIN = 1.25  # of the expected end: friction delays the exit


class Timed:
    """Base of ``scenes.scene.Scene``: the end of its runs."""

    @property
    def time_limit(self: Any) -> float:
        """Time (s) at which a run ends at the latest: the duration, or without one a bound from
        rail, thrust, friction and body forces. A run that has settled or is jammed ends earlier.

        Example:
            >>> scene = tipoff.load("tiny")
            >>> scene.time_limit == scene.duration
            True
            >>> scene.replace({"duration": None}).time_limit  # s
            32.768
        """
        return limit(self)

    @property
    def expected_end(self: Any) -> float:
        """Estimate of the end of a run (s), for plots, progress and costs: the duration, or without
        one the end for a payload without friction."""
        return expected(self)


def limit(scene: Any) -> float:
    """Time (s) at which a run of ``scene`` ends at the latest: its duration, or the bound of the module
    docstring, at most ``longest``."""
    if scene.duration is not None:
        return scene.duration
    record = scene.thrust.record()
    slowest = max(_SLOW, slow(scene))
    distance = max(way(scene), 0.0)
    coasting = distance / slowest
    if (pull := _pull(scene)) < 0.0:
        pushed_on = _pushed(_law(scene, _fixed_gain(scene), 0.0))
        fastest = max(_begun(scene), 0.0) + pushed_on / scene.payload.mass
        coasting = min(coasting, 2.0 * fastest / -pull)
    else:
        own = _coasts_at(scene)
        alone = distance / own if own > _at_rest(scene) else 0.0
        if pull > 0.0:
            falling = math.sqrt(2.0 * distance / pull)
            alone = min(alone, falling) if alone else falling
        coasting = max(coasting, alone)
    # A payload that springs push is faster than this soon, or jammed.
    start = slides(scene, slowest) if isinstance(scene.thrust, PushedTable) else 0.0
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
    return min(max(rounded, scene.output.interval), longest(scene))


def longest(scene: Any) -> float:
    """Longest run (s) without a stated duration: the one with the most samples, at most an hour."""
    return min(MOST_SAMPLES * scene.output.interval, LONGEST)


def burns_too_long(scene: Any) -> float | None:
    """Time (s) that a scene without a duration needs until its thrust is over and rates settle, if
    that is longer than the longest run; else None."""
    if scene.duration is not None:
        return None
    record, most = scene.thrust.record(), longest(scene)
    if at_most(thrust_law.last(record) + SETTLE_WINDOW, most):
        return None
    needed = _burnt(record) + SETTLE_WINDOW
    return needed if below(most, needed) else None


def require(tables: dict[str, Any], output: OutputTable) -> None:
    """Refuse a thrust that lasts longer than a run without a duration can be sampled. ``tables``
    are the tables of a scene that are valid so far, ``output`` its output."""
    if not {"duration", "thrust"} <= tables.keys():  # these have other faults
        return
    needed = burns_too_long(SimpleNamespace(**tables, output=output))
    if needed is not None:
        given, fits_ = apart(output.interval, needed / MOST_SAMPLES, 3)
        raise within(
            "interval",
            f"{given} s, no duration, and a thrust whose rates settle at {needed:.6g} s",
            f"at least {fits_} s (at most {MOST_SAMPLES:,} samples), a thrust "
            f"that ends within {longest(SimpleNamespace(output=output)):g} s, or a duration",
        )


def fits(scene: Any) -> bool:
    """Whether the rail does not end behind every pad, the sampling interval fits the duration, or the
    thrust without one, and strokes end on the rail."""
    if ends_behind_the_pads(scene) or strokes_too_long(scene):
        return False
    if scene.duration is None:
        return burns_too_long(scene) is None
    return scene.output.fits(scene.duration)


def over_time(scene: Any) -> thrust_law.Thrust:
    """The thrust over time. That of springs is an estimate, for a payload without friction on a
    platform that does not turn."""
    return _law(scene, _fixed_gain(scene), _pull(scene))


def _law(scene: Any, gain: float, pull: float) -> thrust_law.Thrust:
    if isinstance(scene.thrust, PushedTable):
        curve = pushed.over_time(scene.thrust, gain, pull, _begun(scene))
        return thrust_law.Thrust(pulses=None, curve=curve)
    return scene.thrust.record()


def spring_impulses(scene: Any) -> np.ndarray:
    """Estimate (n,) N s of the impulse of each of n springs, as ``over_time``."""
    return pushed.impulses(scene.thrust, _fixed_gain(scene), _pull(scene), _begun(scene))


def expected(scene: Any) -> float:
    """Estimate (s) of the end of a run, for plots, progress and costs: the stated duration, or a
    payload without friction until it has settled, with a margin of a quarter."""
    if scene.duration is not None:
        return scene.duration
    record = over_time(scene)
    exits = _exit(scene, record, _fixed_gain(scene), _pull(scene), forwards=False)
    if not math.isfinite(exits):  # it falls back, or nothing moves it
        exits = thrust_law.last(record) + JAM_DURATION
    settled = max(exits + SETTLE_DELAY, _burnt(record)) + SETTLE_WINDOW
    return min(_MARGIN * settled, limit(scene))


def earliest(scene: Any) -> float:
    """Lower bound (s) of the end of the settled window, infinite if the payload cannot leave in an
    hour: no friction, no thrust and no body force backwards, and a platform that recoils along the
    rail with all of its freedom. Zero if bodies turn at ignition, which moves the rail too."""
    initial = scene.initial
    turns = initial is not None and any(
        any((rate.x, rate.y, rate.z)) for rate in (initial.rate, initial.platform_rate)
    )
    force = registry.body_force(scene)
    gain, pull = _freest_gain(scene), max(force.x if force is not None else 0.0, 0.0)
    record = _law(scene, gain, pull)
    exits = 0.0 if turns else _exit(scene, record, gain, pull, forwards=True)
    return max(exits + SETTLE_DELAY, _burnt(record)) + SETTLE_WINDOW


def exit_speed(scene: Any) -> float | None:
    """Estimate (m/s) of the speed along the rail at the exit, of a payload without friction on a
    platform that does not turn; None if it never leaves."""
    record, gain, pull = over_time(scene), _fixed_gain(scene), _pull(scene)
    left = _exit(scene, record, gain, pull, forwards=False)
    if not math.isfinite(left):
        return None
    held = stop.release_time(scene)
    pushed_on = thrust_law.impulse(record, left) - thrust_law.impulse(record, held)
    return _begun(scene) + gain * pushed_on + pull * (left - held)


def is_driven_otherwise(scene: Any) -> bool:
    """Whether anything except the thrust moves the payload along the rail."""
    return _begun(scene) != 0.0 or _pull(scene) != 0.0


def speed_change(scene: Any) -> float:
    """Change (m/s) of the speed along the rail by the whole thrust, on a platform that does not turn."""
    record = over_time(scene)
    return _fixed_gain(scene) * thrust_law.impulse(record, thrust_law.last(record))


def is_too_short(scene: Any) -> bool:
    """Whether no run of ``scene`` can settle within its stated duration, for any friction."""
    return scene.duration is not None and below(scene.duration, earliest(scene))


def slow(scene: Any) -> float:
    """Relative axial speed (m/s) below which friction may hold a payload: the transition speed of its
    friction, 10 mm/s if that has none."""
    return getattr(scene.friction, "static_speed", _SLOW)


def jam_speed(scene: Any) -> float:
    """Relative axial speed (m/s) below which a payload counts as jammed (``mechanics.outcome``)."""
    force, pull, rests = registry.body_force(scene), _pull(scene), _at_rest(scene)
    if stop.release_time(scene) == math.inf:
        return rests
    if not (scene.friction and scene.contact and scene.friction.static > 0.0):
        return rests if pull == 0.0 else 0.0
    if force is not None and pull < 0.0:  # friction of the weight holds it, or it slides back
        holds = scene.friction.static * math.hypot(force.y, force.z) >= -pull
        return slow(scene) if holds else rests
    driven = pull > 0.0 or starts_briskly(scene, slow(scene))
    return slow(scene) if driven or _coasts_at(scene) > slow(scene) else rests


def _at_rest(scene: Any) -> float:
    """Speed (m/s) of a payload that does not leave its rail in the longest run."""
    return min(nominal_way(scene) / LONGEST, slow(scene))


def _coasts_at(scene: Any) -> float:
    """Estimate (m/s) of the axial speed after the thrust of a payload without friction and body
    forces, on a platform that does not turn."""
    gain, begun = _fixed_gain(scene), _begun(scene)
    if isinstance(scene.thrust, PushedTable):
        energy = max(0.0, scene.thrust.energy() - scene.thrust.friction_loss())
        return math.sqrt(max(begun, 0.0) ** 2 + 2.0 * gain * energy)
    return begun + gain * thrust_law.impulse(scene.thrust.record(), math.inf)


def starts_briskly(scene: Any, speed: float) -> bool:
    """Whether a constant thrust from ignition would bring a payload without friction to ``speed``
    (m/s) in half the duration of a jam; a payload that is slow then is held by friction."""
    return (
        scene.thrust.kind == "constant"
        and scene.thrust.start <= 0.0
        and 0.5 * JAM_DURATION * scene.thrust.force * _fixed_gain(scene) >= speed
    )


def slides(scene: Any, speed: float) -> float:
    """Time (s) in which a body force along fixed rails, and springs, bring a payload without
    friction from rest to twice this ``speed`` (m/s); zero without such a force."""
    pull = _pull(scene)
    if isinstance(scene.thrust, PushedTable):
        gain = _fixed_gain(scene)
        pull += gain * float(pushed.net_force(scene.thrust, np.zeros(1), gain, pull)[0])
    return 2.0 * speed / pull if pull > 0.0 and abs(_begun(scene)) < speed else 0.0


def _burnt(record: thrust_law.Thrust) -> float:
    """Time (s) after which the thrust is below 0.1 % of its peak."""
    return thrust_law.burnout(record, _BURNT, 2.0 * thrust_law.last(record) + _UNIT)


def _pushed(record: thrust_law.Thrust) -> float:
    """Impulse (N s) of the forward parts of the thrust."""
    time, force = thrust_law.forces(record)
    return float(np.trapezoid(np.maximum(force, 0.0), time))


def _exit(scene: Any, record: thrust_law.Thrust, gain: float, pull: float, forwards: bool) -> float:
    """Time (s) at which a payload without friction reaches the exit; infinite if it never does.
    ``gain`` is its acceleration relative to the rail per force (1/kg); with ``forwards`` only
    forward forces count."""
    time, force = thrust_law.forces(record)
    force = np.maximum(force, 0.0) if forwards else force
    begun = max(_begun(scene), 0.0) if forwards else _begun(scene)
    distance = way(scene)
    if distance <= 0.0:
        return 0.0
    free = time >= stop.release_time(scene)
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


def _begun(scene: Any) -> float:
    """Speed (m/s) along the rail at ignition."""
    if scene.initial is None:
        return 0.0
    carried = scene.initial.platform_velocity.x if scene.platform is not None else 0.0
    return scene.initial.velocity.x - carried


def _pull(scene: Any) -> float:
    """Acceleration (m/s2) along the rail relative to it; zero on a free platform, which falls like
    the payload."""
    force = registry.body_force(scene)
    return force.x if force is not None and scene.platform is None else 0.0


def _fixed_gain(scene: Any) -> float:
    """Acceleration of the payload relative to the rail per thrust (1/kg); the platform does not
    turn."""
    recoil = 0.0
    if scene.platform is not None and scene.thrust.reaction == "platform":
        recoil = 1.0 / scene.platform.mass
    return 1.0 / scene.payload.mass + recoil


def _freest_gain(scene: Any) -> float:
    """The largest gain: the platform turns too, about the axis of its smallest inertia."""
    gain = _fixed_gain(scene)
    platform = scene.platform
    if platform is None or scene.thrust.reaction != "platform":
        return gain
    across = math.hypot(platform.mass_centre.y, platform.mass_centre.z)
    aside = max(math.hypot(pad.position[1], pad.position[2]) for pad in scene.pads)
    least = float(np.linalg.eigvalsh(tensor(platform.inertia))[0])
    return gain + (across + aside) ** 2 / least
