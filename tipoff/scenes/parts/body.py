"""The body of a payload in the words of its owner: places counted from its tail or its nose, inertia from
length and diameter, and a rail at an angle to the ground.

With ``origin`` the places of buttons, lugs, pads, mass centre, rail and mounts are counted from the tail
(forwards) or from the nose (backwards). X of a place p with the mass centre at c is::

    X = p - c  (tail)          X = c - p  (nose)

A body of which only mass m, length L and diameter 2 r are known is a slender homogeneous cylinder::

    I_xx = m r^2 / 2           I_yy = I_zz = m (3 r^2 + L^2) / 12
"""

import math
from collections.abc import Mapping
from typing import Any, Literal

from tipoff.scenes.parts.made import Made, number, text

Origin = Literal["tail", "nose"]
GRAVITY = 9.80665  # m/s2
_PLACES = ("length", "diameter", "mass_centre")  # of [payload]
KEYS = (*(f"payload.{name}" for name in _PLACES), "gravity.inclination")


def is_stated(raw: dict) -> bool:
    """Whether a scene as written has keys of this module."""
    payload, own = _table(raw, "payload"), _table(raw, "gravity")
    return any(name in payload for name in _PLACES) or "inclination" in own


def drop(tables: dict) -> None:
    """Remove the keys of this module from expanded ``tables``."""
    for name in _PLACES:
        _table(tables, "payload").pop(name, None)
    _table(tables, "gravity").pop("inclination", None)


def expand(made: Made) -> None:
    """Inertia and size, places and gravity."""
    _inertia(made)
    _gravity(made)
    _places(made)


def gravity(raw: Mapping, inclination: float) -> tuple[float, float, float]:
    """Acceleration (m/s2) in scene axes on a rail at this angle (rad) above the horizontal plane, in a scene as
    written: the rail is below its payload, but a payload with lugs hangs below its rod, on which
    nothing holds the roll."""
    side = 1.0 if raw.get("lugs") else -1.0
    return -GRAVITY * math.sin(inclination), 0.0, side * GRAVITY * math.cos(inclination)


def radius(made: Made) -> float | None:
    """Radius (m) of the body on the side of the rail; refuses a payload without one."""
    payload = _table(made.tables, "payload")
    size = payload.get("size")
    if isinstance(size, list) and len(size) == 3:
        height = made.length(size[2])
        return None if height is None else 0.5 * height
    if "diameter" not in payload:
        made.refuse("payload.diameter", "nothing", "the diameter of a body with buttons or lugs")
    return None


def _table(tables: Any, name: str) -> dict:
    found = tables.get(name)
    return found if isinstance(found, dict) else {}


def _inertia(made: Made) -> None:
    payload = _table(made.tables, "payload")
    length, diameter = (
        made.length(payload[name]) if name in payload else None for name in ("length", "diameter")
    )
    if length is None or diameter is None:
        return
    if "size" not in payload:
        size = [text(each) for each in (length, diameter, diameter)]
        made.put("payload.size", size, "from length and diameter of the payload")

    def moments(mass: float) -> dict[str, str]:
        across = mass * (0.75 * diameter**2 + length**2) / 12.0
        found = {"xx": mass * diameter**2 / 8.0, "yy": across, "zz": across}
        return {axis: f"{moment!r} kg*m**2" for axis, moment in found.items()}

    source = (
        "assumed: a slender homogeneous cylinder of the mass, length and diameter of the payload"
    )
    made.put_inertia(payload, moments, source)


def _gravity(made: Made) -> None:
    own = _table(made.tables, "gravity")
    if "inclination" not in own:
        return
    stated = [axis for axis in ("x", "z") if axis in own]
    for axis in stated:
        made.refuse(f"gravity.{axis}", repr(own[axis]), "no such key beside inclination")
    angle = number(own["inclination"], "rad", made.bare)
    if angle is not None and not stated:
        for axis, value in zip("xyz", gravity(made.raw, angle)):
            if axis != "y":
                made.put(f"gravity.{axis}", f"{value!r} m/s**2", "")


def _places(made: Made) -> None:
    origin, payload = made.raw.get("origin"), _table(made.tables, "payload")
    if origin is None:
        if "mass_centre" in payload:
            expected = 'no such key without origin = "tail" or "nose"'
            made.refuse("payload.mass_centre", repr(payload["mass_centre"]), expected)
        return
    if "mass_centre" not in payload:
        made.refuse("payload.mass_centre", "nothing", f"its distance from the {origin}")
        return
    centre = made.length(payload["mass_centre"])
    if centre is None or origin not in ("tail", "nose"):
        return
    sign = 1.0 if origin == "tail" else -1.0

    def along(value: Any) -> Any:
        place = made.length(value)
        return value if place is None else text(sign * (place - centre))

    rail, thrust = _table(made.tables, "rail"), _table(made.tables, "thrust")
    _mounts(made, rail, sign)
    for end in ("start", "end"):
        if end in rail:
            made.put(f"rail.{end}", along(rail[end]), "")
    for name, key in (("pads", "position"), ("buttons", "place"), ("lugs", "place")):
        items = made.tables.get(name)
        for item in items if isinstance(items, list) else ():
            if isinstance(item, dict) and key in item:
                own = item[key]
                if key == "position" and isinstance(own, list) and own:
                    item[key] = [along(own[0]), *own[1:]]
                    foot = item.get("foot")
                    if isinstance(foot, list) and foot:
                        item["foot"] = [along(foot[0]), *foot[1:]]
                elif key == "place":
                    item[key] = along(own)
        if isinstance(items, list):
            made.derived[name] = ""
    if thrust and "arm" not in thrust:
        behind = centre
        if origin == "nose":
            length = made.length(payload.get("length"))
            if length is None:
                made.refuse("payload.length", "nothing", "the length, for the place of the nozzle")
                return
            behind = length - centre
        made.put("thrust.arm", text(behind), "assumed: the nozzle at the tail")


def _mounts(made: Made, rail: dict, sign: float) -> None:
    """Mounts counted from the origin, as stretches from the rear end of the rail."""
    start, mounts = made.length(rail.get("start")), rail.get("mounts")
    if start is None or not isinstance(mounts, list):
        return

    def along(value: Any) -> Any:
        place = made.length(value)
        return value if place is None else text(sign * (place - start))

    moved = [
        {name: along(value) for name, value in span.items()} if isinstance(span, dict) else span
        for span in mounts
    ]
    made.put("rail.mounts", moved, "")
