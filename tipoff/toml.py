"""Writing TOML, which the standard library only reads."""

import json
import math
import re
from collections.abc import Iterator, Mapping
from numbers import Integral, Real
from typing import Any

import numpy as np

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def dumps(table: Mapping[str, Any]) -> str:
    """TOML of a table of text, booleans, numbers, lists and tables. Raises ValueError for a NaN and
    TypeError for a value of any other type."""
    return "\n".join(_lines(table, ())).lstrip("\n") + "\n"


def _lines(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    inner = {key: item for key, item in table.items() if _is_table(item) or _is_tables(item)}
    yield from (f"{_key(key)} = {_value(item)}" for key, item in table.items() if key not in inner)
    for key, item in inner.items():
        here = (*path, key)
        name = ".".join(map(_key, here))
        if not _is_table(item):
            for entry in item:
                yield from ("", f"[[{name}]]", *_lines(entry, here))
        else:
            if not item or not all(map(_is_table, item.values())):
                yield from ("", f"[{name}]")
            yield from _lines(item, here)


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)


def _is_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(map(_is_table, value))


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        if math.isnan(value):
            raise ValueError("a value is NaN")
        return repr(float(value))
    if isinstance(value, str):
        # JSON's escapes are TOML's
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_value, value)) + "]"
    raise TypeError(f"cannot write {type(value).__name__} as TOML")
