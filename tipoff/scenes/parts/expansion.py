"""The tables of a scene that follow from parts of hardware, computed each time a scene is validated.

So a change of a part moves what hangs on it: a vary file that changes the play, the mass or the
place of a button changes pads, rail and inertia too. What a scene states itself is kept.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from tipoff.scenes import overrides as keys
from tipoff.scenes import provenance
from tipoff.scenes.parts import body, buttons, deployer, lugs
from tipoff.scenes.parts.made import Made, number

_WITH_PADS = {  # parts that give pads
    "buttons": buttons.expand,
    "lugs": lugs.expand,
    "deployer": deployer.expand,
}
_OWN = (*_WITH_PADS, "origin")  # parts that are tables or keys of the scene itself


class Expansion(NamedTuple):
    """A scene with what follows from its parts."""

    tables: dict
    derived: dict[str, str]  # source of each dotted key that was added or replaced
    faults: list[tuple[str, str, str]]

    def with_faults(self, found: list[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
        """The faults, and those that a scene ``found``, without those of keys that only follow from a
        refused part."""
        if not self.derived:
            return found
        known = {key for key, _, _ in self.faults}
        incomplete = bool(known) or self.refuses_parts(found)
        return self.faults + [
            (key, given, expected)
            for key, given, expected in found
            if key not in known
            and not (given == "nothing" and (key in self.derived or (incomplete and _follows(key))))
        ]

    @staticmethod
    def refuses_parts(found: list[tuple[str, str, str]]) -> bool:
        """Whether faults that a scene ``found`` are those of parts that give pads."""
        return any(key.partition(".")[0] in _WITH_PADS for key, _, _ in found)


def _follows(key: str) -> bool:
    """Whether a missing ``key`` may be one that parts give."""
    tables = ("pads", "rail", "contact", "friction", "thrust")
    return key.split(".")[0] in tables or key == "payload.inertia"


def has_parts(raw: Any) -> bool:
    """Whether tables of a scene as written have parts."""
    return isinstance(raw, dict) and (any(name in raw for name in _OWN) or body.is_stated(raw))


def expand(raw: dict, bare: bool) -> Expansion:
    """``raw`` with what follows from its parts; itself without parts. ``bare``: whether numbers
    without a unit are SI."""
    if not has_parts(raw):
        return Expansion(raw, {}, [])
    tables = keys.plain(raw)
    made = Made(tables, raw, bare, {}, [])
    body.expand(made)
    first, *others = [*(name for name in _WITH_PADS if name in raw), ""]
    if first:
        _WITH_PADS[first](made)
    for name in filter(None, others):
        made.refuse(name, "a table", f"none beside {first}")
    stated = tables.get("provenance")
    if isinstance(stated, Mapping):
        tables["provenance"] = _with_sources(stated, made.derived)
    elif stated is None:
        tables["provenance"] = _with_sources({}, made.derived)
    return Expansion(tables, made.derived, made.faults)


def open_to(raw: dict, overrides: Mapping[str, Any]) -> dict:
    """``raw``, as it takes ``overrides``: one of a pad that follows from a part changes a pad written
    by hand, so all pads are written out first."""
    if gives_pads(raw) and any(key.startswith("pads.") for key in overrides):
        return written_out(raw)
    return raw


def gives_pads(raw: Mapping) -> bool:
    """Whether the pads of a scene as written follow from its parts."""
    return "pads" not in raw and any(name in raw for name in _WITH_PADS)


def written_out(raw: dict) -> dict:
    """``raw`` without parts: pads, play and places as if written by hand."""
    tables = expand(raw, True).tables
    for name in _OWN:
        tables.pop(name, None)
    body.drop(tables)
    return tables


def as_written(raw: dict) -> dict[str, Any]:
    """Parts of a scene written as ``raw``, and what its expansion replaced, in SI by dotted key; None
    for what it added."""
    if not has_parts(raw):
        return {}
    found: dict[str, Any] = {}
    for key in (*expand(raw, True).derived, *_OWN, *body.KEYS):
        own: Any = raw
        for part in key.split("."):
            own = own.get(part) if isinstance(own, dict) else None
        found[key] = _si(own, "rad" if key.endswith("inclination") else "m")
    return found


def _si(value: Any, unit: str) -> Any:
    if isinstance(value, dict):
        return {name: _si(item, unit) for name, item in value.items()}
    if isinstance(value, list):
        return [_si(item, unit) for item in value]
    found = number(value, unit, True)
    return value if found is None else found


def _with_sources(stated: Mapping, derived: Mapping[str, str]) -> dict:
    texts = dict(keys.dotted(stated))
    own = {
        key: text
        for key, text in derived.items()
        if text and provenance.nearest(texts, key) is None
    }
    return own | texts
