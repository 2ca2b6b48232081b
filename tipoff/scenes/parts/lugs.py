"""``[[lugs]]``: launch lugs of a rocket on a round rod, and the pads that they are.

A lug is a tube around the rod. With its inner diameter D and the diameter d of the rod, the play on each
side is::

    (D - d) / 2

The rod is drawn as an octagon (``scenes.section_shapes.RodTable``), and the lug touches the four of its sides
that face along Y and Z. So the play is exact along Y and Z; on a diagonal it is sqrt 2 of that, in the mean
over all directions 1.12. A lug touches at its ends (``guided.bands``). A face is narrower than its side by the
play on each side, so that it stays over the side.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from pydantic import Field, TypeAdapter

from tipoff.scenes.parts import body, guided, usual
from tipoff.scenes.parts.made import Made, text
from tipoff.scenes.parts.profiles import ROD_MATERIAL, ROD_SOURCE, MaterialName
from tipoff.scenes.section_shapes import rod_side
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import Length, NonNegativeLength, PositiveLength

_BAND, _WALL, _RELIEF = 4e-3, 1e-3, 20e-6  # m
_NARROWEST = 0.25  # of the side of the rod, a face
_GROUPS = [(name,) for name in ("inner_diameter", "length", "height", "relief")]


class LugTable(Table):
    """``[[lugs]]``: one launch lug on a round rod. What a further lug does not state is that of the first
    one."""

    #: Place of its middle along the body, from the origin of the scene.
    place: Length
    #: Inner diameter of the tube. With the diameter of the rod it gives the play.
    inner_diameter: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Length of the tube along the rod.
    length: PositiveLength | None = Field(None, exclude_if=is_absent)
    #: Material of the lug, for what contact does not state.
    material: MaterialName | None = Field(None, exclude_if=is_absent)
    #: Distance of its axis from the surface of the body; half of the inner diameter and a wall of 1 mm
    #: (assumed) where absent.
    height: NonNegativeLength | None = Field(None, exclude_if=is_absent)
    #: Crown of its faces.
    relief: NonNegativeLength | None = Field(None, exclude_if=is_absent)


_TABLES: TypeAdapter = TypeAdapter(tuple[LugTable, ...])


class Lug(NamedTuple):
    """Every dimension of a lug (m)."""

    place: float
    inner_diameter: float
    length: float
    height: float
    relief: float


def expand(made: Made) -> None:
    """Pads, rail, play and contact of the lugs of a scene."""
    if not (found := guided.tables(made, "lugs", _TABLES)):
        return
    rod, radius = _rod(made), body.radius(made)
    if rod is None or radius is None:
        return
    sized_, faults = sized(found, rod)
    made.faults.extend(faults)
    if faults:
        return
    first = sized_[0]
    inside, half = rod_side(rod)
    slant = 0.5 * (inside + half)  # middle of a side between two walls
    play = text(0.5 * (first.inner_diameter - rod))
    source = "from the lugs and the rod"
    missing = {
        "at": [text(0.0), text(-(radius + first.height))],
        "mounted": [[text(y * slant), text(z * slant)] for y in (1, -1) for z in (1, -1)],
        "clearance": play,
        "leg": text(2.0 * half),
        "thickness": text(rod),
        "stretch": usual.STRETCH,
    }
    placed = guided.rail(made, missing, (ROD_MATERIAL, ROD_SOURCE), source)
    if placed is not None:
        y, z, gap = placed
        made.put("pads", [pad for each in sized_ for pad in pads(each, (y, z), rod, gap)], source)
    guided.slides(made, {"clearance": play}, found[0].material, source, "lugs")


def _rod(made: Made) -> float | None:
    """Diameter (m) of the rod."""
    rail = made.tables.get("rail")
    if not isinstance(rail, dict):
        return None
    section = rail.get("section")
    if not isinstance(section, dict) or section.get("shape") != "rod":
        expected = 'a table with shape = "rod" and its diameter'
        made.refuse("rail.section", guided.kind(section), expected)
        return None
    return made.length(section.get("diameter"))


def sized(tables: Sequence[LugTable], rod: float) -> tuple[list[Lug], guided.Faults]:
    """The lugs on a ``rod`` of this diameter (m), and the faults (key, given, expected) of those that do
    not fit."""
    found: list[Lug] = []
    faults: guided.Faults = []
    for number, table in enumerate(tables):
        key, given = f"lugs.{number}", guided.with_first(table, tables[0], _GROUPS)
        wrong = [(f"{key}.{name}", was, words) for name, was, words in _misfits(given, rod)]
        faults += wrong
        if wrong:
            continue
        inner = given["inner_diameter"]
        lug = Lug(
            place=given["place"],
            inner_diameter=inner,
            length=given["length"],
            height=0.5 * inner + _WALL if given["height"] is None else given["height"],
            relief=_RELIEF if given["relief"] is None else given["relief"],
        )
        found.append(lug)
        faults += guided.unequal(key, lug, found[0], ("inner_diameter", "height"))
    return found, faults


def _misfits(given: Mapping, rod: float) -> Iterator[tuple[str, str, str]]:
    for name, example in (("inner_diameter", "7 mm"), ("length", "30 mm")):
        if given[name] is None:
            yield name, "nothing", f"a quantity in m, such as {example}"
    inner = given["inner_diameter"]
    if inner is None:
        return
    _, half = rod_side(rod)
    most = rod + 2.0 * half * (1.0 - _NARROWEST)
    if not rod <= inner <= most:
        words = f"{rod:.6g} m, the diameter of the rod, to {most:.6g} m: more play than its walls have width"
        yield "inner_diameter", f"{inner:g} m", words


def pads(lug: Lug, place: tuple[float, float], rod: float, gap: float) -> list[dict]:
    """The faces of a centred ``lug`` as ``[[pads]]`` with lengths in m, around a ``rod`` of this diameter (m)
    whose middle is at ``place`` (m); each is ``gap`` (m) off its wall."""
    inside, half = rod_side(rod)
    y, z = place
    away = inside + gap
    width = 2.0 * half - (lug.inner_diameter - rod)
    foot = [text(lug.place), text(y), text(z + lug.height)]
    return [
        {
            "position": [text(along), text(y + side * away), text(z + up * away)],
            "foot": foot,
            "normals": [normal],
            "length": f"{length!r} m",
            "width": text(width),
            "relief": f"{lug.relief!r} m",
        }
        for along, length in guided.bands(lug.place, lug.length, _BAND)
        for side, up, normal in ((0, 1, "-z"), (0, -1, "+z"), (1, 0, "-y"), (-1, 0, "+y"))
    ]
