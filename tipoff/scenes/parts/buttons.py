"""``[[buttons]]``: rail buttons of a rocket in the slot of a T-slot rail, and the pads that they are.

A button has a flange on the body, a neck between the lips of the slot and a head behind them::

    body | flange | neck, between the lips | head

It touches the rail with six faces: its flange outside both lips, its head inside them, and its neck
on both sides of the slot. With the width s of the slot, the thickness t of a lip, the diameters d_n
of the neck and d of head and flange, and the height h of the neck, the play on each side is::

    neck to slot  (s - d_n) / 2          head to lip  (h - t) / 2

Edges are rounded: a face ends ``EDGE`` before its part does.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from pydantic import Field

from tipoff.scenes.parts.made import text
from tipoff.scenes.parts.profiles import PROFILES, MaterialName, ProfileName
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import Length, NonNegativeLength, PositiveLength

EDGE = 0.25e-3  # m
_PLAY, _FLANGE_HEIGHT, _LENGTH, _RELIEF = 0.25e-3, 3e-3, 8e-3, 20e-6  # m
_MISSING = "a quantity in m, or a profile"


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
    #: Length of its faces along the rail.
    length: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Crown of its faces.
    relief: NonNegativeLength | None = Field(None, exclude_if=is_absent)


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


_Faults = list[tuple[str, str, str]]


def sized(tables: Sequence[ButtonTable], slot: Slot) -> tuple[list[Button], _Faults]:
    """The buttons in a ``slot``, and the faults (key, given, expected) of those that do not fit."""
    found: list[Button] = []
    faults: _Faults = []
    for number, table in enumerate(tables):
        key = f"buttons.{number}"
        own = {name: getattr(table, name) for name in ButtonTable.model_fields}
        given = _with_first(own, tables[0] if number else None)
        faults += [
            (f"{key}.{play}", f"{own[play]:g} m", f"no such key beside {instead}")
            for play, instead in (("neck_to_slot", "neck"), ("head_to_lip", "neck_height"))
            if own[play] is not None and own[instead] is not None
        ]
        button = _button(given, slot)
        found.append(button)
        faults += [
            (f"{key}.{name}", was, words) for name, was, words in _misfits(button, given, slot)
        ]
        faults += [
            (
                f"{key}.{play}",
                f"{getattr(button, play):g} m",
                f"{getattr(found[0], play):g} m, that of the first button: one rail holds all",
            )
            for play in ("neck_to_slot", "head_to_lip", "flange_height")
            if abs(getattr(button, play) - getattr(found[0], play)) > 1e-9
        ]
    return found, faults


def assumed(tables: Sequence[ButtonTable]) -> str:
    """The dimensions that no button states, in words; empty if there are none."""
    stated = {name for each in tables for name in each.model_fields_set}
    pairs = [("neck", "neck_to_slot"), ("neck_height", "head_to_lip"), ("head", "flange")]
    found = [" or ".join(pair) for pair in pairs if not stated & set(pair)]
    found += [name for name in ("flange_height", "length") if name not in stated]
    return f"{', '.join(found)} of a usual button" if found else ""


def _with_first(own: Mapping, first: ButtonTable | None) -> dict:
    """The keys of a button, with those of the ``first`` one where it states neither of two."""
    if first is None:
        return dict(own)
    found = dict(own)
    for names in (("neck", "neck_to_slot"), ("neck_height", "head_to_lip")):
        if all(own[name] is None for name in names):
            found |= {name: getattr(first, name) for name in names}
    rest = ("profile", "head", "flange", "flange_height", "length", "relief")
    return found | {name: getattr(first, name) if own[name] is None else own[name] for name in rest}


def _button(given: Mapping, slot: Slot) -> Button:
    usual = PROFILES[given["profile"]].head if given["profile"] else None
    side, height = given["neck_to_slot"], given["head_to_lip"]
    if side is None:
        side = _PLAY if given["neck"] is None else round(0.5 * (slot.opening - given["neck"]), 12)
    if height is None:
        own = given["neck_height"]
        height = _PLAY if own is None else round(0.5 * (own - slot.lip), 12)
    head = given["head"] or given["flange"] or usual or 0.0
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


def _or(value: float | None, usual: float) -> float:
    return usual if value is None else value


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
    """The six faces of a centred ``button`` as ``[[pads]]`` with lengths in m, on a profile whose
    middle is at ``place`` (m); each is ``gap`` (m) off its wall."""
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
            "position": [text(button.place), text(y + sign * aside), text(z)],
            "foot": foot,
            "normals": [normal if normal[1:] else f"{'+' if sign > 0 else '-'}y"],
            "length": f"{button.length!r} m",
            "width": text(width),
            "relief": f"{button.relief!r} m",
        }
        for aside, z, normal, width in rows
        for sign in (1, -1)
    ]
