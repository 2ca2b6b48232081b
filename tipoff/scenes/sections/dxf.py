"""Outline of a section from a drawing: closed loops of LINE, ARC and LWPOLYLINE in ASCII DXF.

A file is a list of pairs, a group code and a value on a line each. Every entity of the drawing must
be one of the three; others are refused by name, since a left-out line would change the section. The
bulge of a vertex is the tangent of a quarter of the angle of the arc to the next one. Arcs become
chords that deviate by at most ``DEVIATION`` of the larger extent of the drawing.

Source: Autodesk, DXF Reference, 2012: group codes of LINE, ARC, LWPOLYLINE, and of $INSUNITS.
"""

import math
from pathlib import Path

from tipoff.files import read_input
from tipoff.scenes.sections.outline import Corner

DEVIATION = 0.0025  # of the larger extent
_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}  # of $INSUNITS
_SCALE = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048}
_READ = "LINE, ARC and LWPOLYLINE are read"
_JOINED = 1e-4  # of the larger extent: ends closer than this are one
_MOST_ENTITIES = 2000

Pairs = list[tuple[int, str]]
# the points of an entity: (y, z, bulge to the next one) in units of the drawing
_Path = list[tuple[float, float, float]]


def loops(path: str | Path, unit: str | None) -> list[list[Corner]]:
    """Corners (m) of each closed loop, X of the drawing along Y and Y along Z. ``unit`` of the lengths;
    that of the header if None.

    Raises ValueError for a file that cannot be read as such, with what it lacks.
    """
    pairs = _pairs(path)
    own = _UNITS.get(_units_of_header(pairs))
    if unit is None and own is None:
        raise ValueError('a unit: the drawing states none, so set rail.unit, for example "mm"')
    if unit is not None and own is not None and unit != own:
        raise ValueError(f"no rail.unit, or {own!r}: the drawing states this one")
    scale = _SCALE[unit or own or "m"]
    paths: list[_Path] = []
    closed: list[_Path] = []
    for entity in _entities(pairs):
        (closed if _is_closed(entity) else paths).append(_points(entity))
    every = [point[:2] for each in (*paths, *closed) for point in each]
    if not every:
        raise ValueError(f"closed loops; the drawing has no entities; {_READ}")
    extent = max(max(axis) - min(axis) for axis in zip(*every))
    found = closed + _chained(paths, _JOINED * extent)
    return [
        [(scale * y, scale * z) for y, z in _chords(each, DEVIATION * extent)] for each in found
    ]


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
    return found


def _units_of_header(pairs: Pairs) -> int:
    place = next((n for n, pair in enumerate(pairs) if pair == (9, "$INSUNITS")), None)
    return 0 if place is None else int(_number(pairs[place + 1][1]))


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
    return entity[0][1] == "LWPOLYLINE" and bool(int(_first(entity, 70, "0")) & 1)


def _points(entity: Pairs) -> _Path:
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
    found: _Path = []
    for code, value in entity:
        if code == 10:
            found.append((_number(value), 0.0, 0.0))
        elif code in (20, 42) and found:
            y, z, bulge = found[-1]
            found[-1] = (y, _number(value), bulge) if code == 20 else (y, z, _number(value))
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


def _chained(paths: list[_Path], near: float) -> list[_Path]:
    """Closed loops of open paths, whose ends are at most ``near`` apart."""
    left, found = list(paths), []
    while left:
        chain = left.pop(0)
        while math.dist(chain[0][:2], chain[-1][:2]) > near or len(chain) < 3:
            end = chain[-1][:2]
            place = next((n for n, path in enumerate(left) if _touches(path, end, near)), None)
            if place is None:
                raise ValueError(
                    f"closed loops; one ends at ({end[0]:.6g}, {end[1]:.6g}) of the drawing"
                )
            path = left.pop(place)
            if math.dist(path[0][:2], end) > near:
                path = _reversed(path)
            chain = [*chain[:-1], (*end, path[0][2]), *path[1:]]
        found.append(chain[:-1])
    return found


def _touches(path: _Path, end: Corner, near: float) -> bool:
    return any(math.dist(path[place][:2], end) <= near for place in (0, -1))


def _reversed(path: _Path) -> _Path:
    bulges = [-bulge for _, _, bulge in path[-2::-1]] + [0.0]
    return [(y, z, bulge) for (y, z, _), bulge in zip(path[::-1], bulges)]


def _chords(path: _Path, deviation: float) -> list[Corner]:
    """Corners of a closed path whose arcs are chords."""
    found: list[Corner] = []
    for (y, z, bulge), (to_y, to_z, _) in zip(path, path[1:] + path[:1]):
        found.append((y, z))
        if bulge == 0.0:
            continue
        sweep = 4.0 * math.atan(bulge)
        half_y, half_z = 0.5 * (to_y - y), 0.5 * (to_z - z)
        to_centre = (1.0 - bulge * bulge) / (2.0 * bulge)  # of half of the chord, to its left
        centre = (y + half_y - half_z * to_centre, z + half_z + half_y * to_centre)
        radius, begin = math.dist(centre, (y, z)), math.atan2(z - centre[1], y - centre[0])
        step = 2.0 * math.acos(max(0.0, 1.0 - deviation / radius))
        count = max(2, math.ceil(abs(sweep) / step - 1e-9))
        for part in range(1, count):
            angle = begin + sweep * part / count
            found.append(
                (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))
            )
    return found
