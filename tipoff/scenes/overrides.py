"""Dotted keys such as ``thrust_offset.misalignment.axial`` or ``pads.0.relief``: setting, dropping
and checking them."""

import sys
from collections.abc import Iterator, Mapping
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from tipoff.faults import NO_SUCH_KEY, Fault, SceneError, kind_of
from tipoff.scenes.table import Table

_TEXTS = ("name", "description")
_NAMED = ("conditions", "provenance", "rail.surfaces", "rail.groups")  # with names of the user
DEEPEST = 32  # levels of tables and lists; a scene has five


def require_shallow(raw: Any, source: str) -> None:
    """Raise SceneError unless ``raw`` is a table with names as keys and at most ``DEEPEST`` levels
    of tables and lists. Functions that read tables here are recursive."""
    if not isinstance(raw, Mapping):
        expected = "values by their keys, as a dict or another mapping"
        raise SceneError([Fault(source, "table", kind_of(raw), expected)])
    if wrong := [key for key in raw if not isinstance(key, str)]:
        raise SceneError([Fault(source, "key", repr(key), "a name as text") for key in wrong])
    level: list[Any] = [raw]
    for _ in range(DEEPEST + 1):
        level = [
            item
            for value in level
            for item in (value.values() if isinstance(value, Mapping) else value)
            if isinstance(item, (Mapping, list, tuple))
        ]
        if not level:
            return
    raise SceneError([too_deep(source)])


def too_deep(source: str) -> Fault:
    """The fault of tables that are too deep."""
    expected = f"tables and lists of at most {DEEPEST} levels"
    return Fault(source, "tables", "more levels inside each other", expected)


def index(text: str, length: int) -> int | None:
    """The place in a list of so many items that a part of a dotted key names, or None."""
    # isdigit alone accepts superscripts, and int at most 4300 digits
    is_number = text.isascii() and text.isdigit() and len(text) < 10
    return int(text) if is_number and int(text) < length else None


def plain(value: Any) -> Any:
    """A copy that shares no container with ``value``; tuples become lists, as in TOML."""
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def held(table: Any, key: str) -> Any:
    """What ``table`` holds under the dotted ``key``; None where a key on the way is absent. Methods are
    no values: one law of thrust has the key ``peak``, another one a function of this name."""
    found = table
    for part in key.split("."):
        if isinstance(found, tuple):
            place = index(part, len(found))
            found = None if place is None else found[place]
        else:
            is_field = isinstance(found, Table) and part in type(found).model_fields
            found = getattr(found, part) if is_field else None
    return found


def dotted(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """(dotted key, value) pairs of a nested mapping, so that ``a.b = 1`` and ``"a.b" = 1`` mean the
    same."""
    for key, value in table.items():
        if isinstance(value, Mapping) and value:
            yield from dotted(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def texts(table: Any) -> dict[str, Any] | None:
    """A ``[provenance]`` by dotted key, empty if it is absent; None if it is no table."""
    if table is None or is_drop(table):
        return {}
    return dict(dotted(table)) if isinstance(table, Mapping) else None


def is_key(annotation: Any, key: str) -> bool:
    """Whether a table of type ``annotation`` can hold the dotted ``key``, present or not."""
    part, _, rest = key.partition(".")
    inner = _inside(annotation, part)
    return bool(inner) and (not rest or any(is_key(item, rest) for item in inner))


def unit(annotation: Any, key: str) -> str | None:
    """SI unit of the number that a table of type ``annotation`` has under the dotted ``key``.

    Empty if it depends on other keys (a contact stiffness on its exponent), None without a number.
    """
    part, _, rest = key.partition(".")
    found = [unit(item, rest) if rest else _unit(item) for item in _inside(annotation, part)]
    return next((item for item in found if item is not None), None)


def _unit(annotation: Any) -> str | None:
    if annotation is float:
        return ""
    if get_origin(annotation) not in (Annotated, Union, UnionType):
        return None
    stated = [
        item.json_schema_extra["unit"]
        for item in get_args(annotation)
        if getattr(item, "json_schema_extra", None)
    ]
    found = stated + [_unit(item) for item in get_args(annotation)]
    return next((item for item in found if item is not None), None)


def _inside(annotation: Any, part: str) -> list:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        field = annotation.model_fields.get(part)
        return [Annotated[field.annotation, field]] if field else []
    if get_origin(annotation) in (list, tuple):
        is_index = index(part, sys.maxsize) is not None
        return list(get_args(annotation)[:1]) if is_index else []
    if get_origin(annotation) is dict:
        return [get_args(annotation)[1]]
    return [found for item in get_args(annotation) for found in _inside(item, part)]


def is_drop(value: Any) -> bool:
    """Whether ``value`` drops a table or key."""
    return value is None or (isinstance(value, str) and value == "absent")


def apply_all(
    raw: dict, overrides: Mapping[str, Any], table_type: type
) -> list[tuple[str, str, str]]:
    """Apply overrides in place; returns faults (key, given, expected) of unknown keys.

    The validation of ``table_type`` finds a misspelt key that is set, but not one that is dropped.
    """
    faults = []
    for key, value in overrides.items():
        if is_drop(value) and not is_key(table_type, key):
            faults.append((key, repr(value), NO_SUCH_KEY))
        elif is_drop(value) and (known := _unknown_name(raw, key)):
            faults.append((key, repr(value), known))
        elif fault := apply(raw, key, plain(value)):
            faults.append(fault)
    return faults


def _unknown_name(raw: dict, key: str) -> str | None:
    """The expected names if ``key`` ends on a name of the user that ``raw`` lacks, such as a misspelt
    condition; None for other keys."""
    table, _, name = key.rpartition(".")
    if table not in _NAMED:
        return None
    known: Any = raw
    for part in table.split("."):
        known = known.get(part) if isinstance(known, dict) else None
    names = list(known) if isinstance(known, dict) else []
    return None if name in names else f"one of {', '.join(names) or 'none'}"


def without_absent(raw: Any, table_type: type, key: str = "") -> Any:
    """``raw``, the value of the dotted ``key``, without the keys of a ``table_type`` that it sets to
    "absent": what is not there may be dropped, as by an override. Texts stay, and names that are no keys
    of the table or that the user gives: the validation refuses them."""
    if isinstance(raw, list):
        return [without_absent(item, table_type, f"{key}.{n}") for n, item in enumerate(raw)]
    if not isinstance(raw, dict) or key in _NAMED:
        return raw
    found = {}
    for name, value in raw.items():
        own = f"{key}.{name}" if key else name
        if value == "absent" and own not in _TEXTS and is_key(table_type, own):
            continue
        inner = without_absent(value, table_type, own)
        if inner != {} or value == {}:
            found[name] = inner
    return found


def apply(raw: dict, key: str, value: Any) -> tuple[str, str, str] | None:
    """Set one dotted key in place, or drop it; returns (key, given, expected) if it does not exist.

    A table that loses its last key is dropped too, since an empty table is a fault.
    """
    if key.count(".") >= DEEPEST:
        return key, repr(value), NO_SUCH_KEY
    head, _, rest = key.partition(".")
    return _apply_inside(raw, head, rest, key, value)


def _apply_inside(
    table: Any, head: str, rest: str, key: str, value: Any
) -> tuple[str, str, str] | None:
    place: int | str
    if isinstance(table, list):
        if (found := index(head, len(table))) is None:
            return key, repr(head), f"an index below {len(table)}"
        place = found
    elif isinstance(table, dict):
        place = head
        if is_drop(value) and head not in table:
            return None
        if rest:
            table.setdefault(head, {})
    else:
        return key, repr(head), "a key inside a table"
    if rest:
        fault = _apply_inside(table[place], *rest.partition(".")[::2], key, value)
        if is_drop(value) and table[place] == {}:
            del table[place]
        return fault
    if not is_drop(value):
        table[place] = value
    elif isinstance(table, list):
        return key, "nothing", "a value: an element of a list cannot be removed"
    else:
        del table[place]
    return None
