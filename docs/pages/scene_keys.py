"""Every key of a scene file with its value, default and meaning, from the tables themselves.

    python -m docs.pages.scene_keys        writes them into docs/reference/scene.md, without drawings

The build of the site puts those with drawings in their place.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docs.pages import key_drawings
from docs.pages.markdown import table
from docs.pages.meanings import meanings
from tipoff.scenes.scene import Scene
from tipoff.scenes.table import Table

PAGE = Path(__file__).resolve().parents[1] / "reference" / "scene.md"
_BEGIN, _END = "<!-- every key of a scene -->\n", "<!-- end of the keys -->"
_DRAWING = re.compile(r'<div class="drawing">.*?</div>\n*', re.DOTALL)
_BOUNDS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
_BOUNDS |= {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
_CHOICES = (
    "kind",
    "law",
    "shape",
    "mesh",
    "geometry",
    "section",
)  # the key that tells the tables of one name apart


def markdown() -> str:
    """One section for the scene itself and one for each table. Raises LookupError for a key without
    a meaning."""
    schema = Scene.model_json_schema()
    classes = {each.__name__: each for each in _below(Table)}
    sections = {"The scene itself": _section("The scene itself", schema, Scene)}
    for path, name in _tables(schema, schema["$defs"], ""):  # some stand in rails of any kind
        sections[path] = _section(path, schema["$defs"][name], classes[name])
        if path == "`[[pads]]`":
            sections["`[pads]`"] = _pattern(sections[path])
    return "\n\n".join(sections.values())


def placed(page: str, keys: str) -> str:
    """The text of ``page`` with ``keys`` in their place; unchanged if it has none."""
    if _BEGIN not in page:
        return page
    before, rest = page.split(_BEGIN)
    return f"{before}{_BEGIN}\n{keys}\n\n{_END}{rest.split(_END)[1]}"


def written() -> str:
    """The text of the page of the keys as its file has it: no reader of a file sees drawings."""
    return placed(PAGE.read_text(encoding="utf-8"), _DRAWING.sub("", markdown()))


def _pattern(of_one: str) -> str:
    """Section of pads by pattern, whose other keys are those ``of_one`` pad."""
    rows = [row for row in of_one.splitlines() if re.match(r"\| `(?!position|normals)\w+`", row)]
    own = [
        ("`stations`", "list: `m`", "required", "Places along X of the pads."),
        (
            "`corner`",
            "2 × `m`",
            "required",
            "Distances of the corners from the axis along Y and Z.",
        ),
    ]
    words = "In place of `[[pads]]`: a pad at each of four corners of each station.\n\n"
    head = table(("key", "value", "default", "meaning"), own)
    return f"## `[pads]`\n\n{words}{head}\n" + "\n".join(rows)


def _below(base: type) -> Iterator[Any]:
    for each in base.__subclasses__():
        yield each
        yield from _below(each)


def _tables(schema: dict, known: dict, path: str) -> Iterator[tuple[str, str]]:
    """(heading, class) of every table below ``schema``."""
    for key, entry in schema["properties"].items():
        many = _lists(entry)
        refs = list(_references(entry))
        for name in refs:
            below = f"{path}.{key}" if path else key
            if "additionalProperties" in entry:
                below, many = f"{below}.NAME", True
            shown = f"`[[{below}]]`" if many else f"`[{below}]`"
            yield shown + (_choice(known[name]) if len(refs) > 1 else ""), name
            yield from _tables(known[name], known, below)


def _choice(schema: dict) -> str:
    """What tells this table apart from others of its name."""
    for key in _CHOICES:
        entry = schema["properties"].get(key)
        if entry is not None:
            return f", `{key} = {json.dumps(entry['const'])}`" if "const" in entry else f", `{key}`"
    return ", built-in section"


def _lists(entry: dict) -> bool:
    return entry.get("type") == "array"


def _references(entry: Any) -> Iterator[str]:
    if isinstance(entry, dict):
        if "$ref" in entry:
            yield entry["$ref"].rsplit("/", 1)[1]
        for key, inner in entry.items():
            if key != "discriminator":
                yield from _references(inner)
    elif isinstance(entry, list):
        for inner in entry:
            yield from _references(inner)


def _section(title: str, schema: dict, of: type[Table]) -> str:
    said = meanings(of)
    required = schema.get("required", [])
    rows = [
        (f"`{key}`", _value(entry), _default(key, entry, required), said[key])
        for key, entry in schema["properties"].items()
    ]
    drawn = key_drawings.of(title)
    return f"## {title}\n\n{drawn}" + table(("key", "value", "default", "meaning"), rows)


def _value(entry: dict) -> str:
    """Unit and bounds, or the kind of value."""
    if "anyOf" in entry:
        return " or ".join(_value(each) for each in entry["anyOf"] if each.get("type") != "null")
    if "oneOf" in entry:
        return " or ".join(dict.fromkeys(map(_value, entry["oneOf"])))
    if "$ref" in entry:
        return "table"
    if "const" in entry:
        return f"`{json.dumps(entry['const'])}`"
    if "enum" in entry:
        return " or ".join(f"`{json.dumps(each)}`" for each in entry["enum"])
    if entry["type"] == "array":
        items = entry.get("prefixItems")
        return f"{len(items)} × {_value(items[0])}" if items else f"list: {_value(entry['items'])}"
    if entry["type"] in ("number", "integer"):
        bounds = [f"{sign} {entry[key]:.4g}" for key, sign in _BOUNDS.items() if key in entry]
        unit = entry.get("unit", "quantity") if entry["type"] == "number" else "dimensionless"
        kind = "whole number" if entry["type"] == "integer" else "number"
        return ", ".join([kind if unit == "dimensionless" else f"`{unit}`", *bounds])
    return {"string": "text", "boolean": "`true` or `false`", "object": "tables by name"}[
        entry["type"]
    ]


def _default(key: str, entry: dict, required: list[str]) -> str:
    if key in required:
        return "required"
    default = entry.get("default")
    if default is None:
        return "absent"
    if isinstance(default, dict):
        return "as below"
    if isinstance(default, list | tuple):
        return "none" if not default else json.dumps(default)
    unit = entry.get("unit", "dimensionless")
    if isinstance(default, float):
        return f"{default:g}" if unit == "dimensionless" else f"`{default:g} {unit}`"
    return f"`{json.dumps(default)}`"


if __name__ == "__main__":
    PAGE.write_text(written(), encoding="utf-8")
