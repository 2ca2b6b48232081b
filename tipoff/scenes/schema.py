"""JSON schema of scene files, for completion and checks in an editor.

It describes the text of a file: a quantity is a string with a unit, an inherited table can be
"absent", and a file that ``extends`` another states its changes. Whether tables fit each other is
checked when the scene is read.
"""

import re
from collections.abc import Iterator
from typing import Any

from tipoff.scenes import overrides, reading, suggestions
from tipoff.scenes.scene import Scene
from tipoff.units import to_si

_NUMBER = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
QUANTITY = rf"^(absent|\s*{_NUMBER}\s*[^\s\d.+-].*)$"
_PURE = rf"^(absent|\s*{_NUMBER}\s*\D*)$"
_BOUNDS = {
    "gt": "exclusiveMinimum",
    "ge": "minimum",
    "lt": "exclusiveMaximum",
    "le": "maximum",
}
_BESIDE = ("name", "description", "studies", "conditions", "agreement", "provenance")


def schema() -> dict:
    """The schema (draft 7) as JSON values."""
    found = _of_file(Scene.model_json_schema())
    properties = found["properties"]
    properties["format"] = {
        "const": reading.FORMAT,
        "description": "Number of the format of this file.",
    }
    properties["extends"] = {
        "type": "string",
        "description": "Scene of the catalogue, or file, whose tables this file changes.",
    }
    properties["pads"] = {"anyOf": [properties["pads"], _pattern(found["$defs"]["PadTable"])]}
    properties["conditions"]["additionalProperties"] = {
        "anyOf": [{"const": "absent"}, {"type": "object", "properties": _dotted()}]
    }
    required = [
        name
        for name, field in Scene.model_fields.items()
        if field.is_required() and name not in ("name", "pads")  # without a name, that of the file
    ]
    whole = [{"required": [*required, pads]} for pads in ("pads", "buttons", "lugs")]
    whole.append({"required": [*(name for name in required if name != "rail"), "deployer"]})
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "tipoff scene",
        **found,
        "anyOf": [*whole, {"required": ["extends"]}],
    }


def _of_file(node: Any, name: str = "") -> Any:
    """A part of pydantic's schema of SI values, converted to the schema of the text of a file;
    ``name`` is its key."""
    if isinstance(node, list):
        return [_of_file(item, name) for item in node]
    if not isinstance(node, dict):
        return node
    if node.get("type") == "number":
        return _quantity(node, name)
    if node == {"type": "null"}:
        return {"const": "absent"}
    found = {}
    for key, value in node.items():
        if key in ("properties", "$defs"):
            found[key] = {inner: _of_file(item, inner) for inner, item in value.items()}
        elif key == "prefixItems":  # three equal ones
            found["items"] = _of_file(value[0], name)
        elif key == "oneOf":  # without required keys, several can fit
            found["anyOf"] = _of_file(value, name)
        elif key not in ("required", "default", "discriminator", "title"):
            found[key] = _of_file(value, name)
    return found


def _quantity(node: dict, name: str) -> dict:
    unit = node.get("unit", "its unit")
    examples = _examples(name, unit)
    described = {"description": f"quantity in {unit}"} | (
        {"examples": examples} if examples else {}
    )
    if "default" in node and unit not in ("its unit", "dimensionless"):
        described["default"] = f"{node['default']:g} {unit}"
    if unit != "dimensionless":
        return {"type": "string", "pattern": QUANTITY, **described}
    bounds = {_BOUNDS[key]: value for key, value in node.items() if key in _BOUNDS}
    return {
        "anyOf": [{"type": "number", **bounds}, {"type": "string", "pattern": _PURE}],
        "description": "number",
    }


def _examples(name: str, unit: str) -> list[str]:
    """Texts in scenes of the catalogue under keys of this ``name`` with the dimension of ``unit``, or a
    common one."""
    found = dict.fromkeys(
        text
        for key, text in suggestions.written().items()
        if name and key.rpartition(".")[2] == name and _has_dimension(text, unit)
    )
    common = suggestions.COMMON.get(unit)
    return list(found)[:3] or ([common] if name and common else [])


def _has_dimension(text: str, unit: str) -> bool:
    if not re.match(QUANTITY, text):
        return False
    if unit == "its unit":
        return True
    try:
        to_si(text, unit)
    except ValueError:
        return False
    return True


def _pattern(pad: dict) -> dict:
    """Pads by pattern (``scenes.pads``)."""
    common = {
        key: item for key, item in pad["properties"].items() if key not in ("position", "normals")
    }
    length = pad["properties"]["length"] | {"default": None, "examples": ["80 mm"]}
    del length["default"]
    places = {"type": "array", "items": length}
    return {
        "type": "object",
        "description": "One pad at each of four corners of each station.",
        "additionalProperties": False,
        "properties": {
            "stations": places,
            "corner": {**places, "minItems": 2, "maxItems": 2},
            **common,
        },
    }


def _dotted() -> dict[str, dict]:
    """Dotted keys that a condition may change."""
    return dict(_changes())


def _changes() -> Iterator[tuple[str, dict]]:
    for key in suggestions.keys(Scene):
        if key.split(".")[0] in _BESIDE or ".0." in key:
            continue
        unit = overrides.unit(Scene, key)
        words = f"quantity in {unit}" if unit else "table or value"
        yield key, {"description": f'{words}; "absent" drops it'}
