"""``[[buttons]]``: rail buttons of a rocket in the slot of a T-slot rail, and the pads that they are.

A button has a flange on the body, a neck between the lips of the slot and a head behind them::

    body | flange | neck, between the lips | head

It touches the rail with six faces: its flange outside both lips, its head inside them, and its neck
on both sides of the slot. With the width s of the slot, the thickness t of a lip, the diameters d_n
of the neck and d of head and flange, and the height h of the neck, the play on each side is::

    neck to slot  (s - d_n) / 2          head to lip  (h - t) / 2

Edges are rounded: a face ends ``EDGE`` before its part does. A shoe is a long button: it has these six
faces at each of its ends.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from pydantic import Field, TypeAdapter

from tipoff.scenes.parts import body, guided, usual
from tipoff.scenes.parts.made import Made, text
from tipoff.scenes.parts.profiles import (
    PROFILES,
    RAIL_MATERIAL,
    RAIL_SOURCE,
    MaterialName,
    ProfileName,
)
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import Length, NonNegativeLength, PositiveLength

EDGE = 0.25e-3  # m
_PLAY, _FLANGE_HEIGHT, _LENGTH, _RELIEF = 0.25e-3, 3e-3, 8e-3, 20e-6  # m
_MISSING = "a quantity in m, or a profile"
_SECTION = ("width", "slot", "lip", "cavity", "depth", "web")
# what a further button takes from the first one, if it states none of them
_GROUPS = (
    ("neck_to_slot", "neck"),
    ("head_to_lip", "neck_height"),
    *((name,) for name in ("profile", "head", "flange", "flange_height", "length", "relief")),
)


class ButtonTable(Table):
    """``[[buttons]]``: one rail button. What a further button does not state is that of the first
    one."""

    #: Place of its middle along the body, from the origin of the scene.
    place: Length
    #: Profile of the rail that the button fits: its dimensions where none are given, and those of
    #: the rail, where it has no section.
    profile: ProfileName | None = Field(None, exclude_if=is_absent)
    #: Material of the button, for what contact does not state.
    material: MaterialName | None = Field(None, exclude_if=is_absent)
    #: Diameter of the neck between the lips.
    neck: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Height of the neck, from the flange to the head.
    neck_height: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Diameter of the head behind the lips.
    head: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Diameter of the flange outside the lips.
    flange: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Height of the flange, from the body to the neck.
    flange_height: NonNegativeLength | None = Field(None, exclude_if=is_absent)
    #: Play of the centred neck in the slot on each side, in place of neck.
    neck_to_slot: NonNegativeLength | None = Field(None, exclude_if=is_absent)
    #: Play of the centred head, and of the flange, to the lips, in place of neck_height.
    head_to_lip: NonNegativeLength | None = Field(None, exclude_if=is_absent)
    #: Length along the rail: that of its faces, or of a shoe, which has faces at both of its ends.
    length: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Crown of its faces.
    relief: NonNegativeLength | None = Field(None, exclude_if=is_absent)


_TABLES: TypeAdapter = TypeAdapter(tuple[ButtonTable, ...])


class Slot(NamedTuple):
    """The slot of a rail (m)."""

    width: float  # of the profile
    opening: float
    lip: float
    cavity: float


class Button(NamedTuple):
    """Every dimension of a button (m)."""

    place: float
    neck: float
    head: float
    flange: float
    flange_height: float
    neck_to_slot: float
    head_to_lip: float
    length: float
    relief: float


def expand(made: Made) -> None:
    """Pads, rail, play and contact of the buttons of a scene."""
    if not (found := guided.tables(made, "buttons", _TABLES)):
        return
    slot, radius = _slot(made, found[0]), body.radius(made)
    if slot is None or radius is None:
        return
    sized_, faults = sized(found, slot)
    made.faults.extend(faults)
    if faults:
        return
    words = assumed(found)
    source = f"assumed: {words}" if words else "from the buttons and the section of the rail"
    _placed(made, sized_, slot, radius, source)
    first = sized_[0]
    play = {"clearance": text(first.neck_to_slot)}
    if first.head_to_lip != first.neck_to_slot:
        play["clearance_z"] = text(first.head_to_lip)
    guided.slides(made, play, found[0].material, source, "buttons")


def _slot(made: Made, first: ButtonTable) -> Slot | None:
    """The slot of the rail; its section is that of the profile of the ``first`` button where it has
    none."""
    rail = made.tables.get("rail")
    if not isinstance(rail, dict):
        return None
    if first.profile is not None and not any(name in rail for name in guided.FILES):
        profile = PROFILES[first.profile]
        of_profile = {name: text(getattr(profile, name)) for name in _SECTION}
        made.put("rail.section", {"shape": "t_slot"} | of_profile, profile.source)
    section = rail.get("section")
    if not isinstance(section, dict) or section.get("shape") != "t_slot":
        expected = 'a table with shape = "t_slot", or a profile'
        made.refuse("rail.section", guided.kind(section), expected)
        return None
    width, slot, lip, cavity = (
        made.length(section.get(name)) for name in ("width", "slot", "lip", "cavity")
    )
    if width is None or slot is None or lip is None or cavity is None:
        return None  # the scene refuses them
    return Slot(width, slot, lip, cavity)


def _placed(made: Made, sized: list[Button], slot: Slot, radius: float, source: str) -> None:
    """Place of the profile, and the pads on it, whose dimensions have a ``source``."""
    first = sized[0]
    edge = 0.5 * slot.width
    missing = {
        "at": [text(each) for each in at(first, radius, slot)],
        "mounted": [[text(sign * 0.6 * edge), text(-edge)] for sign in (1, -1)],
        "clearance": text(first.neck_to_slot),
        "leg": text(0.5 * (slot.cavity - slot.opening)),
        "thickness": text(slot.lip),
        "stretch": usual.STRETCH,
    }
    placed = guided.rail(made, missing, (RAIL_MATERIAL, RAIL_SOURCE), source)
    if placed is not None:
        y, z, gap = placed
        made.put("pads", [pad for each in sized for pad in pads(each, (y, z), slot, gap)], source)


def sized(tables: Sequence[ButtonTable], slot: Slot) -> tuple[list[Button], guided.Faults]:
    """The buttons in a ``slot``, and the faults (key, given, expected) of those that do not fit."""
    found: list[Button] = []
    faults: guided.Faults = []
    for number, table in enumerate(tables):
        key = f"buttons.{number}"
        given = guided.with_first(table, tables[0], _GROUPS)
        faults += [
            (f"{key}.{play}", f"{getattr(table, play):g} m", f"no such key beside {instead}")
            for play, instead in _GROUPS[:2]
            if getattr(table, play) is not None and getattr(table, instead) is not None
        ]
        button = _button(given, slot)
        found.append(button)
        faults += [
            (f"{key}.{name}", was, words) for name, was, words in _misfits(button, given, slot)
        ]
        names = ("neck_to_slot", "head_to_lip", "flange_height")
        faults += guided.unequal(key, button, found[0], names)
    return found, faults


def assumed(tables: Sequence[ButtonTable]) -> str:
    """The dimensions that no button states, in words; empty if there are none."""
    stated = {name for each in tables for name in each.model_fields_set}
    pairs = [("neck", "neck_to_slot"), ("neck_height", "head_to_lip"), ("head", "flange")]
    found = [" or ".join(pair) for pair in pairs if not stated & set(pair)]
    found += [name for name in ("flange_height", "length") if name not in stated]
    return f"{', '.join(found)} of a usual button" if found else ""


def _button(given: Mapping, slot: Slot) -> Button:
    of_profile = PROFILES[given["profile"]].head if given["profile"] else None
    side, height = given["neck_to_slot"], given["head_to_lip"]
    if side is None:
        side = _PLAY if given["neck"] is None else round(0.5 * (slot.opening - given["neck"]), 12)
    if height is None:
        own = given["neck_height"]
        height = _PLAY if own is None else round(0.5 * (own - slot.lip), 12)
    head = given["head"] or given["flange"] or of_profile or 0.0
    return Button(
        place=given["place"],
        neck=slot.opening - 2.0 * side,
        head=head,
        flange=given["flange"] or head,
        flange_height=_or(given["flange_height"], _FLANGE_HEIGHT),
        neck_to_slot=side,
        head_to_lip=height,
        length=_or(given["length"], _LENGTH),
        relief=_or(given["relief"], _RELIEF),
    )


def _or(value: float | None, other: float) -> float:
    return other if value is None else value


def _misfits(button: Button, given: Mapping, slot: Slot) -> Iterator[tuple[str, str, str]]:
    if not button.head:
        yield "head", "nothing", _MISSING
        return
    if not given["profile"] and given["neck"] is None and given["neck_to_slot"] is None:
        yield "neck", "nothing", f"{_MISSING}, or neck_to_slot"
    if not given["profile"] and given["neck_height"] is None and given["head_to_lip"] is None:
        yield "neck_height", "nothing", f"{_MISSING}, or head_to_lip"
    least = slot.opening + 4.0 * EDGE
    for part in ("head", "flange"):
        if not getattr(button, part) > least:
            given_ = f"{getattr(button, part):g} m"
            yield part, given_, f"more than {least:.6g} m: it stands on the lips of the slot"
    if not button.head < slot.cavity:
        yield "head", f"{button.head:g} m", f"less than {slot.cavity:.6g} m, the cavity of the slot"
    name = "neck" if given["neck"] is not None else "neck_to_slot"
    if button.neck_to_slot < 0.0 or button.neck <= 0.0:
        yield name, f"{button.neck:g} m", f"a neck within the slot of {slot.opening:.6g} m"
    if button.head_to_lip < 0.0:
        words = f"at least {slot.lip:.6g} m, the lip of the slot"
        yield "neck_height", f"{given['neck_height']:g} m", words


def at(button: Button, radius: float, slot: Slot) -> tuple[float, float]:
    """Place (m) of the middle of the profile across the rail, below a body of this ``radius`` (m)."""
    down = radius + button.flange_height + button.head_to_lip + 0.5 * slot.width
    return 0.0, -round(down, 12)


def pads(button: Button, place: tuple[float, float], slot: Slot, gap: float) -> list[dict]:
    """The faces of a centred ``button`` as ``[[pads]]`` with lengths in m, on a profile whose middle is at
    ``place`` (m); each is ``gap`` (m) off its wall."""
    y, outside = place[0], place[1] + 0.5 * slot.width
    half = 0.5 * slot.opening
    inside, across = outside - slot.lip, half - gap
    flange, head = 0.5 * (half + 0.5 * button.flange), 0.5 * (half + 0.5 * button.head)
    rows = [
        (flange, outside + gap, "-z", 0.5 * button.flange - half - 2.0 * EDGE),
        (head, inside - gap, "+z", 0.5 * button.head - half - 2.0 * EDGE),
        (across, 0.5 * (outside + inside), "y", slot.lip - 2.0 * EDGE),
    ]
    foot = [text(button.place), text(y), text(outside + button.head_to_lip + button.flange_height)]
    return [
        {
            "position": [text(along), text(y + sign * aside), text(z)],
            "foot": foot,
            "normals": [normal if normal[1:] else f"{'+' if sign > 0 else '-'}y"],
            "length": f"{length!r} m",
            "width": text(width),
            "relief": f"{button.relief!r} m",
        }
        for along, length in guided.bands(button.place, button.length, _LENGTH)
        for aside, z, normal, width in rows
        for sign in (1, -1)
    ]
