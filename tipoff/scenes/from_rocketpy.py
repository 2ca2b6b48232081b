"""A scene from a flight of RocketPy: the rocket on its rail in the words of its hardware."""

import math
import re
from typing import Any

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.formats.designs.rocketpy import Launch, UnreadableFlight, read_flight
from tipoff.scenes.parts import usual
from tipoff.scenes.scene import Scene, parse

_SOURCE = "flight of RocketPy"
_ROUNDING = 1e-12  # of an inertia that was turned
_NAME = re.compile(r"[^A-Za-z0-9._-]+")


def scene_of(flight: Any) -> Scene:
    """The scene of a ``flight``. Raises SceneError, every fault listed."""
    try:
        launch = read_flight(flight)
    except UnreadableFlight as error:
        raise SceneError([Fault(_SOURCE, *fault) for fault in error.faults]) from error
    return parse(tables(launch), _SOURCE)


def tables(launch: Launch) -> dict[str, Any]:
    """The scene of a ``launch`` as a file has it."""
    rear, front = launch.buttons
    inertia = launch.inertia
    button = {"profile": "1515", "material": "acetal"}
    if launch.button_height is not None:
        button["flange_height"] = _text(launch.button_height, "m")
    found: dict[str, Any] = {
        "name": _NAME.sub("_", launch.name).strip("._-")[:64] or "rocketpy",
        "description": f"The rocket of the flight {launch.name or 'of RocketPy'} on its rail, from RocketPy.",
        "origin": "tail",
        "payload": {
            "mass": _text(launch.mass, "kg"),
            "diameter": _text(launch.diameter, "m"),
            "mass_centre": _text(launch.mass_centre, "m"),
            "inertia": {
                f"{'xyz'[row]}{'xyz'[column]}": _text(inertia[row, column], "kg*m**2")
                for row in range(3)
                for column in range(row, 3)
                if row == column or abs(inertia[row, column]) > _ROUNDING * inertia.max()
            },
        },
        "buttons": [{"place": _text(rear, "m")} | button, {"place": _text(front, "m")}],
        "rail": {
            "start": "0 m",
            "end": _text(launch.rail_length, "m"),
            "mounts": [
                {"start": _text(start, "m"), "end": _text(end, "m")}
                for start, end in usual.mounts(launch.rail_length)
            ],
        },
        "gravity": {"inclination": _angle(launch.inclination)},
        "initial": {"settled": True},
        "contact": {"law": "impact"},
        "friction": {"static": 0.2, "dynamic": 0.2},
        "thrust": {
            "kind": "measured",
            "points": launch.thrust.tolist(),
            "time_unit": "s",
            "thrust_unit": "N",
            "arm": _text(launch.mass_centre, "m"),
            "reaction": "exhaust",
        },
        "hand_over": {
            "heading": _angle(launch.heading),
            "elevation": _text(launch.elevation, "m"),
            "dry_mass_centre": _text(launch.dry_mass_centre, "m"),
            "angular_position": _angle(launch.angular_position),
        },
        "output": {"interval": "0.5 ms"},
        "studies": {"element_size": usual.element_size(launch.rail_length), "rail_modes": 8},
        "provenance": {
            "buttons": "assumed: profile, and buttons of acetal",
            "rail": "assumed: clamps on a tower",
            "contact": "assumed: acetal on aluminium",
            "friction": "assumed: acetal on aluminium",
        }
        | {key: f"RocketPy: {field}" for key, field in launch.sources.items()},
    }
    if launch.length is not None:
        found["payload"]["length"] = _text(launch.length, "m")
    for table, line in (("mass_offset", launch.mass_line), ("thrust_offset", launch.thrust_line)):
        if any(line):
            found[table] = {"eccentricity": _polar(*line)}
    stated = {key: text for key, text in found["provenance"].items() if _is_stated(found, key)}
    return found | {"provenance": stated}


def _is_stated(found: dict, key: str) -> bool:
    """Whether the tables have a dotted key."""
    own: Any = found
    for part in key.split("."):
        own = own[int(part)] if isinstance(own, list) else own.get(part)
        if own is None:
            return False
    return True


def _polar(y: float, z: float) -> dict[str, str]:
    """The eccentricity of an offset along Y and Z (``scenes.polar``)."""
    return {"axial": _text(math.hypot(y, z), "m"), "radial": _angle(math.atan2(y, z))}


def _angle(value: float) -> str:
    return _text(math.degrees(value), "deg")


def _text(value: float | np.floating, unit: str) -> str:
    """A quantity in twelve digits, without the rounding of sums."""
    return f"{float(value):.12g} {unit}"
