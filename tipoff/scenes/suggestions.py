"""Help with faults of a scene: the names that a user probably meant, and examples of a value.

A key is compared with all dotted keys that a scene can have. The example of a key is its text in a
scene of the catalogue, in a common unit.
"""

import functools
import re
import tomllib
from collections.abc import Iterator
from typing import Any, get_args

from tipoff.faults import MOST_NAMES, NO_SUCH_KEY, close
from tipoff.scenes import overrides, pads, reading
from tipoff.scenes.table import Table

_EXAMPLE = re.compile('for example "[^"]*"')
# for keys that are in no scene of the catalogue
COMMON = {
    "m": "1 mm",
    "m/s": "1 m/s",
    "rad": "0.1 deg",
    "rad/s": "5 deg/s",
    "s": "1 ms",
    "K/m": "10 K/m",
    "N": "100 N",
    "N/m": "100 N/mm",
    "N*s/m": "10 N*s/m",
    "Pa": "70 GPa",
}


def expected(annotation: Any, key: str, words: str) -> str:
    """Text of the value ``expected`` under a dotted ``key`` of a table of type ``annotation``, with
    the keys that were probably meant, or with an example in the common unit of the key."""
    if words == NO_SUCH_KEY:
        return words + _meant(annotation, key)
    if _EXAMPLE.search(words) and (example := _example(annotation, key)):
        return _EXAMPLE.sub(f'for example "{example}"', words)
    return words


def _meant(annotation: Any, key: str) -> str:
    """The keys with the same last part, such as payload.mass for mass, those of the outer tables if
    there are many; else similar keys."""
    key = _bare(key)
    known = list(dict.fromkeys(keys(annotation)))
    if key in known:
        return f" in this kind of {key.rpartition('.')[0]}; another kind has it"
    same = [name for name in known if name.rpartition(".")[2] == key.rpartition(".")[2]]
    if len(same) > MOST_NAMES:
        outer = min(name.count(".") for name in same)
        same = [name for name in same if name.count(".") == outer]
    if same and len(same) <= MOST_NAMES:
        return f", did you mean {' or '.join(same)}?"
    return close(key, known)


def keys(annotation: Any, prefix: str = "") -> Iterator[str]:
    """Dotted keys, including those of tables, that a table of type ``annotation`` can have; ``0``
    represents the items of a list."""
    if isinstance(annotation, type) and issubclass(annotation, Table):
        for name, field in annotation.model_fields.items():
            yield f"{prefix}{name}"
            yield from keys(field.annotation, f"{prefix}{name}.")
        return
    inside = get_args(annotation)
    if getattr(annotation, "__origin__", None) in (list, tuple):
        prefix, inside = f"{prefix}0.", inside[:1]
    for item in inside:
        if not isinstance(item, str):
            yield from keys(item, prefix)


def _bare(key: str) -> str:
    """``key`` without its condition, and with 0 for every place in a list."""
    parts = key.split(".")
    if parts[0] == "conditions" and len(parts) > 2:
        parts = parts[2:]
    return ".".join("0" if part.isdigit() else part for part in parts)


def _example(annotation: Any, key: str) -> str | None:
    key = _bare(key)
    if (found := written().get(key)) is not None:
        return found
    return COMMON.get(overrides.unit(annotation, key) or "")


@functools.cache
def written() -> dict[str, str]:
    """Texts of quantities by dotted key, from the scenes of the catalogue."""
    found: dict[str, str] = {}
    paths = sorted(reading.CATALOG.glob("*.toml"), key=lambda path: path.stem != "reference")
    for path in paths:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
        pads.expand(raw)
        tables = [raw, *raw.get("conditions", {}).values()]
        for table in tables:
            for key, text in _texts(table):
                found.setdefault(_bare(key), text)
    return found


def _texts(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Dotted keys and texts that begin with a number."""
    if isinstance(value, dict):
        for name, item in value.items():
            yield from _texts(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from _texts(item, f"{key}.{place}")
    elif isinstance(value, str) and re.match(r"\s*[+-]?\.?\d", value):
        yield key, value
