"""Checks of the plain values of a result: finite numbers, in the types that a file has."""

import json
from typing import Any

from tipoff.mechanics import outcome


def require_plain(plain: dict[str, Any]) -> None:
    """Raise ValueError if the JSON of a file has other types than ``save`` writes."""
    for name in ("checks", "cost", "scene", "numerics", "versions"):
        if not isinstance(plain[name], dict):
            raise ValueError(f"{name}: given {plain[name]!r}, expected a table")
    values = plain["checks"] | {"wall_s": plain["cost"].get("wall_s", 0.0)}
    for name, value in values.items():
        if not outcome.is_number(value):
            raise ValueError(f"{name}: given {value!r}, expected a number")
    if not is_finite(plain):
        raise ValueError("a number that is not finite")


def is_finite(plain: dict) -> bool:
    """Whether every number of nested dicts and lists is finite, as the JSON encoder sees it."""
    try:
        json.dumps(plain, allow_nan=False)
    except ValueError:
        return False
    return True


def numbers(value, path=()):
    """(path, float) of every float inside nested dicts and lists."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, (*path, str(key)))
    elif isinstance(value, (list, tuple)):
        for index, item in enumerate(value):
            yield from numbers(item, (*path, str(index)))
    elif isinstance(value, float):
        yield path, value
