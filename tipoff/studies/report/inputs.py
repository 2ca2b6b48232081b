"""The scene as the report shows it: every value with its unit and origin."""

import math
import typing
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from tipoff.scenes import provenance as origin
from tipoff.scenes.scene import Scene
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Table, number
from tipoff.units import registry
from tipoff.workspace.words import counted

_SCALED = ("m", "s", "N", "Pa", "m/s", "Hz")
_ASSUMED = ("assumed", "not stated", "inferred")  # origins that stand first
_APART = {"name", "description", "conditions", "provenance", "agreement", "pads"}


def values(table_: BaseModel, prefix: str = "") -> Iterator[tuple[str, Any, str, bool]]:
    """(dotted key, value, SI unit, whether the file states it) of every field with a value."""
    for name, field in type(table_).model_fields.items():
        value, key = getattr(table_, name), f"{prefix}{name}"
        if value is None or field.exclude or (not prefix and name in _APART):
            continue
        if isinstance(value, BaseModel):
            yield from values(value, key + ".")
        elif isinstance(value, (list, tuple)) and value and isinstance(value[0], BaseModel):
            for index, item in enumerate(value):
                yield from values(item, f"{key}.{index}.")
        elif isinstance(value, dict):
            for name_, items in value.items():
                if isinstance(items[0], str):
                    yield f"{key}.{name_}", items, "", True
                    continue
                for index, item in enumerate(items):
                    yield from values(item, f"{key}.{name_}.{index}.")
        else:
            yield key, value, _unit(field), name in table_.model_fields_set


def _unit(field) -> str:
    extra = field.json_schema_extra
    return (
        extra["unit"]
        if isinstance(extra, dict) and "unit" in extra
        else _unit_inside(field.annotation)
    )


def _unit_inside(annotation) -> str:
    for item in getattr(annotation, "__metadata__", ()):
        if isinstance(extra := getattr(item, "json_schema_extra", None), dict) and "unit" in extra:
            return extra["unit"]
    return next((unit for part in typing.get_args(annotation) if (unit := _unit_inside(part))), "")


def readable(value: Any, unit: str) -> str:
    """A value with its unit as text: angles in degrees, lengths, times and forces with a prefix."""
    if isinstance(value, (list, tuple)):
        return ", ".join(readable(item, unit) for item in value) or "none"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if unit == "rad":
        return f"{math.degrees(value):.6g} deg"
    if unit == "rad/s":
        return f"{math.degrees(value):.6g} deg/s"
    if unit in _SCALED and value != 0.0:
        return f"{registry().Quantity(value, unit).to_compact():.6g~P}"
    symbol = "" if unit in ("", "dimensionless") else f" {registry().Unit(unit):~P}"
    return number(value, ".6g") + symbol


def provenance(scene: Scene, key: str, stated: bool) -> str:
    """The origin of a key, or of its table, as the scene states it; "default" for a key that the
    file does not contain."""
    found = origin.nearest(scene.provenance, key)
    return found if found is not None else "not stated" if stated else "default"


def scene_tables(scene: Scene) -> list[Part]:
    """All values, the pads, the conditions, the effects that are absent."""
    rows = []
    for key, value, unit, stated in values(scene):
        if key == "contact.stiffness":
            assert scene.contact is not None
            unit = f"N/m**{scene.contact.exponent:g}"
        rows.append((f"`{key}`", readable(value, unit), provenance(scene, key, stated)))
    rows.sort(key=lambda row: not row[2].startswith(_ASSUMED))
    pads = [
        (
            index + 1,
            readable(pad.position, "m"),
            ", ".join(pad.normals),
            f"{readable(pad.length, 'm')} x {readable(pad.width, 'm')}",
            readable(pad.inset, "m"),
            readable(pad.relief, "m"),
        )
        for index, pad in enumerate(scene.pads)
    ]
    conditions = [
        (
            name,
            _role(scene, name),
            "; ".join(f"{key} = {value}" for key, value in overrides.items()),
        )
        for name, overrides in scene.conditions.items()
    ]
    parts: list[Part] = [
        Table(("key", "value", "provenance"), rows),
        Fold(
            f"{counted(len(pads), 'pad')} ({provenance(scene, 'pads', True)})",
            [Table(("pad", "corner x, y, z", "faces", "size", "inset", "relief"), pads)],
        ),
    ]
    if conditions:
        table = Table(("condition", "role", "differences from the scene"), conditions)
        parts.append(Fold(counted(len(conditions), "condition"), [table]))
    absent = ", ".join(scene.absent_effects()) or "none"
    return [*parts, f"Effects that this scene lacks; no compiled code contains them: {absent}."]


def _role(scene: Scene, name: str) -> str:
    return next(
        (
            role.replace("_", " ")
            for role in ("fitted", "held_out")
            if name in getattr(scene.agreement, role)
        ),
        "",
    )
