"""The tables of a scene that follow from parts of hardware, computed each time a scene is validated.

So a change of a part moves what hangs on it: a vary file that changes the play, the mass or the
place of a button changes pads, rail and inertia too. What a scene states itself is kept.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

from tipoff.scenes import overrides as keys
from tipoff.scenes import provenance
from tipoff.scenes.parts import body, buttons, deployer
from tipoff.scenes.parts.made import Made, number, text
from tipoff.scenes.parts.profiles import (
    FRICTION,
    MATERIALS,
    PROFILES,
    RAIL_MATERIAL,
    RAIL_SOURCE,
)

_BUTTONS: TypeAdapter = TypeAdapter(tuple[buttons.ButtonTable, ...])
_FILES = ("mesh", "geometry", "section")
_WITH_PADS = ("buttons", "deployer")  # parts that give pads
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
    if "buttons" in raw:
        _of_buttons(made)
    if "deployer" in raw:
        if "buttons" in raw:
            made.refuse("deployer", "a table", "none beside buttons")
        else:
            deployer.expand(made)
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


def _of_buttons(made: Made) -> None:
    if "pads" in made.raw:
        made.refuse("pads", "a table", "none beside buttons, which are pads; or no buttons")
        return
    made.derived["pads"] = ""
    try:
        found = _BUTTONS.validate_python(
            made.tables["buttons"], context={"bare_numbers_are_si": made.bare}
        )
    except ValidationError:  # the scene has the same faults
        return
    if not found:
        made.refuse("buttons", "none", "at least one of them")
        return
    slot = _slot(made, found[0])
    radius = body.radius(made)
    if slot is None or radius is None:
        return
    sized, faults = buttons.sized(found, slot)
    made.faults.extend(faults)
    if faults:
        return
    usual = buttons.assumed(found)
    source = f"assumed: {usual}" if usual else "from the buttons and the section of the rail"
    _placed(made, sized, slot, radius, source)
    first = sized[0]
    play = {"clearance": text(first.neck_to_slot)}
    if first.head_to_lip != first.neck_to_slot:
        play["clearance_z"] = text(first.head_to_lip)
    contact = made.tables.get("contact")
    if isinstance(contact, dict) and "clearance" not in contact:
        made.put_absent("contact", play, source)
    if (name := found[0].material) is not None:
        made.put_absent("contact", MATERIALS[name], f"assumed: buttons of {name}")
    friction = made.tables.get("friction")
    if isinstance(friction, dict) and friction.get("law", "two-step") == "two-step":
        made.put_absent("friction", FRICTION, "assumed")


def _slot(made: Made, first: buttons.ButtonTable) -> buttons.Slot | None:
    """The slot of the rail; its section is that of the profile of the ``first`` button where it has
    none."""
    rail = made.tables.get("rail")
    if not isinstance(rail, dict):
        return None
    if first.profile is not None and not any(name in rail for name in _FILES):
        profile = PROFILES[first.profile]
        of_profile = {name: text(getattr(profile, name)) for name in _TABLE}
        made.put("rail.section", {"shape": "t_slot"} | of_profile, profile.source)
    section = rail.get("section")
    if not isinstance(section, dict) or section.get("shape") != "t_slot":
        made.refuse("rail.section", kind(section), 'a table with shape = "t_slot", or a profile')
        return None
    width, slot, lip, cavity = (
        made.length(section.get(name)) for name in ("width", "slot", "lip", "cavity")
    )
    if width is None or slot is None or lip is None or cavity is None:
        return None  # the scene refuses them
    return buttons.Slot(width, slot, lip, cavity)


_TABLE = ("width", "slot", "lip", "cavity", "depth", "web")


def kind(section: Any) -> str:
    """What a section is, for a message."""
    return repr(section) if isinstance(section, str) else "no such section"


def _placed(
    made: Made, sized: list[buttons.Button], slot: buttons.Slot, radius: float, source: str
) -> None:
    """Place of the profile, and the pads on it, whose dimensions have a ``source``."""
    first, rail = sized[0], made.tables["rail"]
    edge = 0.5 * slot.width
    missing = {
        "at": [text(each) for each in buttons.at(first, radius, slot)],
        "mounted": [[text(sign * 0.6 * edge), text(-edge)] for sign in (1, -1)],
        "clearance": text(first.neck_to_slot),
        "leg": text(0.5 * (slot.cavity - slot.opening)),
        "thickness": text(slot.lip),
        "stretch": 3,
    }
    made.put_absent("rail", missing, source)
    if "material" not in rail:
        made.put("rail.material", dict(RAIL_MATERIAL), RAIL_SOURCE)
    y, z = (made.length(each) for each in (*_two(rail["at"]),))
    gap = made.length(rail["clearance"])
    if y is None or z is None or gap is None:
        return  # the scene refuses them
    pads = [pad for each in sized for pad in buttons.pads(each, (y, z), slot, gap)]
    made.put("pads", pads, source)


def _two(place: Any) -> tuple[Any, Any]:
    return (place[0], place[1]) if isinstance(place, list) and len(place) == 2 else (None, None)
