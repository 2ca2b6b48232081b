"""Outline of a section from a drawing: closed loops of LINE, ARC and LWPOLYLINE in ASCII DXF.

A file is a list of pairs, a group code and a value on a line each. Every entity of the drawing must
be one of the three; others are refused by name, since a left-out line would change the section.

Source: Autodesk, DXF Reference, 2012: group codes of LINE, ARC, LWPOLYLINE, and of $INSUNITS
and $MEASUREMENT.
"""

import math
from pathlib import Path

from tipoff.files import read_input
from tipoff.formats.declared import Format
from tipoff.formats.sections.drawn import Drawn
from tipoff.formats.sections.loops import Polyline, closed_loops
from tipoff.units import LENGTHS_OF_FILES

_SURVEY = 1200.0 / 3937.0  # m, a foot of the US survey
_UNITS = (  # of $INSUNITS from 1 on, in m; 0 is none
    ("inches", 0.0254),
    ("feet", 0.3048),
    ("miles", 1609.344),
    ("millimetres", 1e-3),
    ("centimetres", 1e-2),
    ("metres", 1.0),
    ("kilometres", 1e3),
    ("microinches", 2.54e-8),
    ("mils", 2.54e-5),
    ("yards", 0.9144),
    ("angstroms", 1e-10),
    ("nanometres", 1e-9),
    ("microns", 1e-6),
    ("decimetres", 0.1),
    ("decametres", 10.0),
    ("hectometres", 100.0),
    ("gigametres", 1e9),
    ("astronomical units", 149597870700.0),
    ("light years", 9460730472580800.0),
    ("parsecs", 149597870700.0 * 648000.0 / math.pi),
    ("US survey feet", _SURVEY),
    ("US survey inches", _SURVEY / 12.0),
    ("US survey yards", 3.0 * _SURVEY),
    ("US survey miles", 5280.0 * _SURVEY),
)
_SYSTEMS = {0: "inches", 1: "metric"}  # of $MEASUREMENT, which chooses hatches and line types
_READ = "LINE, ARC and LWPOLYLINE are read"
_MOST_ENTITIES = 2000

Pairs = list[tuple[int, str]]


def read_dxf(path: str | Path, unit: str | None) -> Drawn:
    """Corners (m) of each closed loop, X of the drawing along Y and Y along Z. ``unit`` of the lengths;
    that of the header if None.

    Raises ValueError for a file that cannot be read as such, with what it lacks.
    """
    pairs = _pairs(path)
    stated = _unit_of_header(pairs)
    if unit is None and stated is None:
        system = _SYSTEMS.get(_of_header(pairs, "$MEASUREMENT", -1))
        hint = f" ($MEASUREMENT: {system})" if system else ""
        raise ValueError(f'a unit: the drawing states none{hint}, so set rail.unit, such as "mm"')
    if (
        unit is not None
        and stated is not None
        and not math.isclose(LENGTHS_OF_FILES[unit], stated[1])
    ):
        raise ValueError(f"no rail.unit: the drawing states {stated[0]} in $INSUNITS")
    scale = stated[1] if stated is not None else LENGTHS_OF_FILES[unit or "m"]
    still_open: list[Polyline] = []
    closed: list[Polyline] = []
    for entity in _entities(pairs):
        (closed if _is_closed(entity) else still_open).append(_points(entity))
    if not still_open and not closed:
        raise ValueError(f"closed loops; the drawing has no entities; {_READ}")
    return Drawn(closed_loops(still_open, closed, scale))


def _pairs(path: str | Path) -> Pairs:
    content = read_input(path)
    if content.startswith(b"AutoCAD Binary DXF"):
        raise ValueError("an ASCII DXF; this one is binary: export it as text")
    lines = content.decode("latin-1").splitlines()
    found = []
    for number in range(0, len(lines) - 1, 2):
        try:
            found.append((int(lines[number]), lines[number + 1].strip()))
        except ValueError:
            raise ValueError(
                f"an ASCII DXF, a list of group codes and values; line {number + 1} has no code"
            ) from None
    if (0, "EOF") not in found:
        raise ValueError("a whole ASCII DXF; the end, EOF, is missing")
    return found[: found.index((0, "EOF")) + 1]


def _unit_of_header(pairs: Pairs) -> tuple[str, float] | None:
    """Name of the unit in the header, and its length (m)."""
    code = _of_header(pairs, "$INSUNITS", 0)
    if not 0 <= code <= len(_UNITS):
        raise ValueError(f"$INSUNITS from 0 to {len(_UNITS)}, not {code}")
    return _UNITS[code - 1] if code else None


def _of_header(pairs: Pairs, name: str, default: int) -> int:
    place = next((n for n, pair in enumerate(pairs) if pair == (9, name)), None)
    return default if place is None else int(_number(pairs[place + 1][1]))


def _entities(pairs: Pairs) -> list[Pairs]:
    """Each entity of the drawing, without those on layers or in blocks elsewhere."""
    starts = [
        n
        for n, pair in enumerate(pairs)
        if pair == (2, "ENTITIES") and n and pairs[n - 1] == (0, "SECTION")
    ]
    if len(starts) != 1:
        raise ValueError("one section ENTITIES in the drawing")
    found: list[Pairs] = []
    for code, value in pairs[starts[0] + 1 :]:
        if (code, value) == (0, "ENDSEC"):
            break
        if code == 0:
            found.append([])
        if found:
            found[-1].append((code, value))
    other = sorted({entity[0][1] for entity in found} - {"LINE", "ARC", "LWPOLYLINE"})
    if other:
        raise ValueError(f"no {', '.join(other)} in the drawing; {_READ}: explode or convert them")
    if len(found) > _MOST_ENTITIES:
        raise ValueError(f"at most {_MOST_ENTITIES} entities, not {len(found)}")
    return found


def _is_closed(entity: Pairs) -> bool:
    return entity[0][1] == "LWPOLYLINE" and bool(int(_number(_first(entity, 70, "0"))) & 1)


def _points(entity: Pairs) -> Polyline:
    kind = entity[0][1]
    if _number(_first(entity, 230, "1")) < 0.0:
        raise ValueError(f"entities seen from above; a {kind} is mirrored (group 230 is negative)")
    if kind == "LINE":
        places = [(_of(entity, a), _of(entity, b)) for a, b in ((10, 20), (11, 21))]
        return [(*places[0], 0.0), (*places[1], 0.0)]
    if kind == "ARC":
        y, z, radius = (_of(entity, code) for code in (10, 20, 40))
        begin, end = (math.radians(_of(entity, code)) for code in (50, 51))
        sweep = (end - begin) % (2.0 * math.pi)
        bulge = math.tan(0.25 * sweep)
        return [
            (y + radius * math.cos(angle), z + radius * math.sin(angle), bulge)
            for angle in (begin, begin + sweep)
        ]
    found: Polyline = []
    for code, value in entity:
        if code == 10:
            found.append((_number(value), 0.0, 0.0))
        elif code in (20, 42) and found:
            y, z, bulge = found[-1]
            found[-1] = (y, _number(value), bulge) if code == 20 else (y, z, _number(value))
    if not found:
        raise ValueError(f"a whole drawing; a {kind} has no group 10")
    return found


def _first(entity: Pairs, code: int, default: str | None = None) -> str:
    found = next((value for each, value in entity if each == code), default)
    if found is None:
        raise ValueError(f"a whole drawing; a {entity[0][1]} has no group {code}")
    return found


def _of(entity: Pairs, code: int) -> float:
    return _number(_first(entity, code))


def _number(text: str) -> float:
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise ValueError(f"numbers in the drawing, not {text!r}")
    return found


FORMATS = (
    Format(
        "DXF",
        read_dxf,
        [("DXF as text, `.dxf`", "closed loops of `LINE`, `ARC` and `LWPOLYLINE`")],
        suffixes=(".dxf",),
        is_any_other=True,
    ),
)
