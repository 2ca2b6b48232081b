"""Provenance of values: free text under dotted keys. A key without text has the text of the
innermost table around it.

An overridden key gets the text "user", unless a new provenance is given. The other keys of its
table then get the text of the table, and the text of the table ends with ", in part user".
"""

from collections.abc import Iterable, Mapping
from typing import Any

from tipoff.scenes import overrides as keys
from tipoff.scenes.overrides import index

USER = "user"
_PARTLY = ", in part user"
_NO_QUANTITIES = ("name", "description", "studies", "conditions", "agreement", "provenance")


def overridden(
    stated: Mapping[str, str],
    raw: Mapping[str, Any],
    changes: Mapping[str, bool],
    given: Mapping[str, str],
) -> dict[str, str]:
    """Provenance by dotted key of a scene written as ``raw`` after ``changes``: dotted keys that
    were set, and True for keys that were dropped. ``stated`` is the provenance before, ``given``
    that of the changes."""
    found = {**stated, **given}
    for key, dropped in changes.items():
        if key.partition(".")[0] in _NO_QUANTITIES:
            continue
        for other in [
            other for other in found if other not in given and f"{other}.".startswith(f"{key}.")
        ]:
            del found[other]
        if (text := nearest(given, key)) is None:
            _pass_on(found, raw, key)
            if not dropped:
                found[key] = USER
        # an inner table had its own text
        elif nearest(found, key) != text:
            found[key] = text
    return found


def mark(raw: dict, changed: Mapping[str, Any]) -> None:
    """Update the provenance in ``raw``, in which the values ``changed`` were set."""
    stated = keys.texts(raw.get("provenance"))
    if stated is None:
        return
    given = keys.texts(changed.get("provenance")) or {}
    given |= {
        key.removeprefix("provenance."): text
        for key, text in changed.items()
        if key.startswith("provenance.")
    }
    before = {key: text for key, text in stated.items() if key not in given}
    changes = {key: keys.is_drop(value) for key, value in changed.items()}
    raw["provenance"] = overridden(
        before, raw, changes, {key: text for key, text in given.items() if key in stated}
    )


def nearest(texts: Mapping[str, str], key: str) -> str | None:
    """The text of a dotted key or of the innermost table around it; None without a text."""
    parts = key.split(".")
    return next(
        (
            texts[name]
            for length in range(len(parts), 0, -1)
            if (name := ".".join(parts[:length])) in texts
        ),
        None,
    )


def _pass_on(found: dict[str, str], raw: Any, key: str) -> None:
    """Give the text of each table around ``key`` to its other keys."""
    text, table, path = None, raw, ""
    for part, following in zip(parts := key.split("."), parts[1:]):
        path, table = f"{path}.{part}" if path else part, _inside(table, part)
        if isinstance(own := found.get(path), str):
            text = own.removesuffix(_PARTLY)
            found[path] = text + _PARTLY
        if text is not None:
            for beside in _names(table):
                if beside != following:
                    found.setdefault(f"{path}.{beside}", text)


def _names(table: Any) -> Iterable[str]:
    return (
        list(table)
        if isinstance(table, dict)
        else map(str, range(len(table)))
        if isinstance(table, list)
        else ()
    )


def _inside(table: Any, part: str) -> Any:
    if isinstance(table, dict):
        return table.get(part)
    place = index(part, len(table)) if isinstance(table, list) else None
    return None if place is None else table[place]
