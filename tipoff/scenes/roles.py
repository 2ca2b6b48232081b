"""Checks of the tables outside the physics: names of conditions, roles of conditions, keys of
provenance."""

from typing import Any

from tipoff.scenes import names
from tipoff.scenes.faults import renamed
from tipoff.scenes.overrides import is_key
from tipoff.scenes.table import MOST


def faults(raw: dict[str, Any], scene_type: type) -> list[tuple[str, str, str]]:
    """Faults (key, given, expected) of the names in ``[conditions]``, and of ``[agreement]`` and
    ``[provenance]`` in a scene of ``scene_type``."""
    conditions, roles, provenance = (
        _table(raw.get(name)) for name in ("conditions", "agreement", "provenance")
    )
    # values that are no text, and too many of them, are faults of the table
    lists = {
        role: [name for name in members[:MOST] if isinstance(name, str)]
        for role, members in roles.items()
        if isinstance(members, list)
    }
    found = names.faults(conditions)
    found += [
        (f"conditions.{name}.{key}", repr(value), "a key of the scene itself, for all conditions")
        for name, table in list(conditions.items())[:MOST]
        for key, value in _table(table).items()
        if key.partition(".")[0] in ("studies", "agreement")
    ]
    found += [
        (f"agreement.{role}", repr(name), "a name from [conditions]")
        for role, members in lists.items()
        for name in members
        if name not in conditions
    ]
    # a fitted condition is no test of a prediction
    found += [
        ("agreement.held_out", repr(name), "a condition that is not fitted")
        for name in lists.get("held_out", [])
        if name in lists.get("fitted", [])
    ]
    return found + [
        (f"provenance.{key}", repr(text), renamed(key) or "the dotted key of a quantity")
        for key, text in provenance.items()
        if not is_key(scene_type, key)
    ]


def _table(value: Any) -> dict:
    return value if isinstance(value, dict) else {}
