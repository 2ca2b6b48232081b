"""Travel along the rail from ignition to the exit, and the rails and strokes that do not fit it."""

import math
from types import SimpleNamespace
from typing import Any

from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.faults import within
from tipoff.scenes.rounding import apart, below


def way(scene: Any) -> float:
    """Travel (m) along the rail from ignition to the exit: the trailing edge of the rearmost pad
    reaches the end of the rail. A payload that turns has a little more or less."""
    begun = scene.initial.position.x if scene.initial is not None else 0.0
    return nominal_way(scene) - begun


def nominal_way(scene: Any) -> float:
    """``way`` (m) of a payload that begins at its nominal place. ``scene`` needs pads and rail."""
    return scene.rail.end - min(pad.position[0] - 0.5 * pad.length for pad in scene.pads)


def way_off_the_rear_end(scene: Any) -> float:
    """Place along the rail (m), relative to the nominal one, at which the leading edge of the foremost pad
    is at the start of the rail; -infinity for a payload that begins behind it."""
    begun = scene.initial.position.x if scene.initial is not None else 0.0
    place = scene.rail.start - max(pad.position[0] + 0.5 * pad.length for pad in scene.pads)
    return place if place < begun else -math.inf


def pads_beyond(scene: Any, end: float, way: float) -> list[int]:
    """Numbers of the pads that begin wholly beyond an ``end`` (m) of the rail; ``way``: 1 for the open
    end, -1 for the rear end."""
    begun = scene.initial.position.x if scene.initial is not None else 0.0
    return [
        number
        for number, pad in enumerate(scene.pads)
        if below(way * end, way * (pad.position[0] + begun) - 0.5 * pad.length)
    ]


def require_way(scene: Any) -> None:
    """Refuse a ``scene`` whose rail ends behind every pad."""
    if not ends_behind_the_pads(scene):
        return
    end = scene.rail.end
    given, least = apart(end, end - nominal_way(scene))
    words = f"more than {least} m, the rear edge of the rearmost pad"
    raise within("rail.end", f"{given} m", f"{words}: the rail is behind every pad")


def ends_behind_the_pads(scene: Any) -> bool:
    """Whether the rail ends behind every pad of a payload at its nominal place, and at the place where it
    begins."""
    return not below(0.0, max(nominal_way(scene), way(scene)), scene.rail.end)


def with_strokes_on_the_rail(thrust: Any, tables: dict[str, Any]) -> Any:
    """The table ``thrust``; refuses springs with a stroke that ends beyond the exit. ``tables`` are
    the tables of a scene that are valid so far."""
    if not {"pads", "rail"} <= tables.keys():  # these have other faults
        return thrust
    if wrong := strokes_too_long(SimpleNamespace(**tables, thrust=thrust)):
        strokes = {key: float(spring.push().travel[-1]) for key, spring in thrust.named()}
        texts = [apart(strokes[key], longest) for key, longest in wrong]
        way = max((text for _, text in texts), key=len)
        raise within(
            ".".join(filter(None, [wrong[0][0].rstrip("."), "stroke"])),
            ", ".join(f"{given} m" for given, _ in texts),
            f"at most {way} m, the way to the exit: a pusher reaches its stop on the rail",
        )
    return thrust


def strokes_too_long(scene: Any) -> list[tuple[str, float]]:
    """Keys of the springs whose stroke (m) is longer than the way to the exit, and that way."""
    if not isinstance(scene.thrust, PushedTable):
        return []
    whole = nominal_way(scene)
    if whole <= 0.0:  # the fault is that of the rail
        return []
    return [
        (key, whole)
        for key, spring in scene.thrust.named()
        if below(whole, float(spring.push().travel[-1]))
    ]
