"""The launch of a scene along its rail (``mechanics.estimates``), and the scenes that it refuses: rails,
strokes and thrusts that do not fit each other.
"""

import math
from typing import Any

from tipoff.mechanics.estimates import ends
from tipoff.mechanics.estimates.launch import Launch
from tipoff.mechanics.laws.thrust import Thrust, last
from tipoff.mechanics.run_limits import MOST_SAMPLES, SETTLE_WINDOW, SLOW
from tipoff.scenes.body import tensor
from tipoff.scenes.effects import hold_down, registry, spring
from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.faults import within
from tipoff.scenes.rounding import apart, at_most, below
from tipoff.scenes.tables import OutputTable


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
        return self.duration if self.duration is not None else ends.limit(of_scene(self))

    @property
    def expected_end(self: Any) -> float:
        """Estimate of the end of a run (s), for plots, progress and costs: the duration, or without
        one the end for a payload without friction."""
        return self.duration if self.duration is not None else ends.expected(of_scene(self))


def of_scene(scene: Any) -> Launch:
    """The launch of ``scene``."""
    thrust, platform, first, latch = scene.thrust, scene.platform, scene.initial, scene.hold_down
    reacts = platform is not None and thrust.reaction == "platform"
    latched = hold_down.release_time(scene)
    is_steady = thrust.kind == "constant" and thrust.start <= 0.0 and latched == 0.0
    carried = first.platform_velocity.x if first is not None and platform is not None else 0.0
    rates = (first.rate, first.platform_rate) if first is not None else ()
    tilt = scene.thrust_offset
    return Launch(
        thrust=thrust.record(),
        pushers=spring.record(thrust, None, None, None),
        steady=thrust.force if is_steady else 0.0,
        along=tilt.misalignment.direction()[0] if tilt is not None else 1.0,
        mass=scene.payload.mass,
        recoil=1.0 / platform.mass if reacts else 0.0,
        platform_inertia=tensor(platform.inertia) if reacts else None,
        lever=_lever(platform, scene.pads) if reacts else 0.0,
        is_free=platform is not None,
        body_force=registry.body_force(scene),
        begun=first.velocity.x - carried if first is not None else 0.0,
        place=_begun(first),
        turns=any(any((rate.x, rate.y, rate.z)) for rate in rates),
        rests=(first is None or first.velocity.x == 0.0) and (latch is None or not latch.is_open),
        latched=latched,
        rail=(scene.rail.start, scene.rail.end),
        pads=(_rear(scene.pads), max(pad.position[0] + 0.5 * pad.length for pad in scene.pads)),
        friction=scene.friction.static if scene.friction and scene.contact else 0.0,
        slow=getattr(scene.friction, "static_speed", SLOW),
        duration=scene.duration,
        interval=scene.output.interval,
    )


def _lever(platform: Any, pads: Any) -> float:
    across = math.hypot(platform.mass_centre.y, platform.mass_centre.z)
    return across + max(math.hypot(pad.position[1], pad.position[2]) for pad in pads)


def _rear(pads: Any) -> float:
    """X (m) of the trailing edge of the rearmost pad."""
    return min(pad.position[0] - 0.5 * pad.length for pad in pads)


def _begun(first: Any) -> float:
    return first.position.x if first is not None else 0.0


def pads_beyond(scene: Any, end: float, way: float) -> list[int]:
    """Numbers of the pads that begin wholly beyond an ``end`` (m) of the rail; ``way``: 1 for the open
    end, -1 for the rear end."""
    begun = _begun(scene.initial)
    return [
        number
        for number, pad in enumerate(scene.pads)
        if below(way * end, way * (pad.position[0] + begun) - 0.5 * pad.length)
    ]


def require_way(scene: Any) -> None:
    """Refuse a ``scene`` whose rail ends behind every pad."""
    if not _ends_behind_the_pads(scene):
        return
    end, rear = scene.rail.end, _rear(scene.pads)
    given, least = apart(end, rear)
    words = f"more than {least} m, the rear edge of the rearmost pad"
    raise within("rail.end", f"{given} m", f"{words}: the rail is behind every pad")


def _ends_behind_the_pads(scene: Any) -> bool:
    """Whether the rail ends behind every pad of a payload at its nominal place, and at the place where it
    begins."""
    way = scene.rail.end - _rear(scene.pads)
    return not below(0.0, max(way, way - _begun(scene.initial)), scene.rail.end)


def with_strokes_on_the_rail(thrust: Any, tables: dict[str, Any]) -> Any:
    """The table ``thrust``; refuses springs with a stroke that ends beyond the exit. ``tables`` are
    the tables of a scene that are valid so far."""
    if not {"pads", "rail"} <= tables.keys():  # these have other faults
        return thrust
    if wrong := _strokes_too_long(thrust, tables["rail"], tables["pads"]):
        strokes = {key: float(spring.push().travel[-1]) for key, spring in thrust.named()}
        texts = [apart(strokes[key], longest) for key, longest in wrong]
        way = max((text for _, text in texts), key=len)
        raise within(
            ".".join(filter(None, [wrong[0][0].rstrip("."), "stroke"])),
            ", ".join(f"{given} m" for given, _ in texts),
            f"at most {way} m, the way to the exit: a pusher reaches its stop on the rail",
        )
    return thrust


def _strokes_too_long(thrust: Any, rail: Any, pads: Any) -> list[tuple[str, float]]:
    """Keys of the springs whose stroke (m) is longer than the way to the exit, and that way."""
    if not isinstance(thrust, PushedTable):
        return []
    whole = rail.end - _rear(pads)
    if whole <= 0.0:  # the fault is that of the rail
        return []
    return [
        (key, whole)
        for key, spring in thrust.named()
        if below(whole, float(spring.push().travel[-1]))
    ]


def require_samples(tables: dict[str, Any], output: OutputTable) -> None:
    """Refuse a thrust that lasts longer than a run without a duration can be sampled. ``tables``
    are the tables of a scene that are valid so far, ``output`` its output."""
    if not {"duration", "thrust"} <= tables.keys() or tables["duration"] is not None:
        return  # no key: these have other faults
    needed = _burns_too_long(tables["thrust"].record(), output.interval)
    if needed is not None:
        given, fits_ = apart(output.interval, needed / MOST_SAMPLES, 3)
        raise within(
            "interval",
            f"{given} s, no duration, and a thrust whose rates settle at {needed:.6g} s",
            f"at least {fits_} s (at most {MOST_SAMPLES:,} samples), a thrust "
            f"that ends within {ends.longest(output.interval):g} s, or a duration",
        )


def _burns_too_long(thrust: Thrust, interval: float) -> float | None:
    """Time (s) that a scene without a duration needs until its thrust is over and rates settle, if
    that is longer than the longest run; else None."""
    most = ends.longest(interval)
    if at_most(last(thrust) + SETTLE_WINDOW, most):
        return None
    needed = ends.settles_after(thrust)
    return needed if below(most, needed) else None


def fits(scene: Any) -> bool:
    """Whether the rail does not end behind every pad, the sampling interval fits the duration, or the
    thrust without one, and strokes end on the rail."""
    if _ends_behind_the_pads(scene) or _strokes_too_long(scene.thrust, scene.rail, scene.pads):
        return False
    if scene.duration is None:
        return _burns_too_long(scene.thrust.record(), scene.output.interval) is None
    return scene.output.fits(scene.duration)
