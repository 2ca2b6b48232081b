"""Outline of a section from a solid in a STEP file that is an extrusion.

The solid is an extrusion along d if its faces are of two kinds: planes normal to d, at two places, its
ends; and planes, cylinders and extruded curves along d, its sides. Then the section is the same at every
place between the ends. Its border is made of the edges that only one face of an end has.

Axes: d points to the positive side of the axis of the file that is nearest to it. The axes of the file
after this one, in the order x, y, z, x, y, are Y and Z of the section: with an extrusion along z of the
file, Y is x and Z is y, as in a drawing. If d is no axis of the file, they are turned with the nearest one
to d, by the smallest angle.
"""

import math
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from tipoff.formats.declared import Format
from tipoff.formats.outline import Corner, outline
from tipoff.formats.sections.drawn import Drawn
from tipoff.formats.sections.loops import LARGEST, Polyline, closed_loops
from tipoff.formats.sections.step_solid import WAY_OUT, Edge, Face, Solid, read_solid
from tipoff.units import LENGTHS_OF_FILES

_ANGLE = 1e-6  # rad: directions closer than this are one
_SAME = 1e-6  # of the extent: places closer than this are one
_DIGITS = 9  # of coordinates in metres: a wall in a plane has equal ones
_ALIKE = 1e-6  # of area and perimeter of both ends


def read_step(path: str | Path, unit: str | None) -> Drawn:
    """The section of the solid in a file. ``unit`` of the lengths if the file states none.

    Raises OSError, and ValueError for a file without one solid that is an extrusion, with what it has.
    """
    found = read_solid(path)
    if found.unit is None and unit is None:
        raise ValueError('a unit: the file states none, so set rail.unit, for example "mm"')
    scale = found.unit or LENGTHS_OF_FILES[unit or "m"]
    if unit is not None and not math.isclose(scale, LENGTHS_OF_FILES[unit]):
        own = next(
            (name for name, metres in LENGTHS_OF_FILES.items() if math.isclose(metres, scale)), ""
        )
        raise ValueError(
            f"no rail.unit{f', or {own!r}' if own else ''}: the file states {scale:g} m"
        )
    return _extrusion(found, scale)


def _extrusion(found: Solid, scale: float) -> Drawn:
    every = np.concatenate([face.points() for face in found.faces])
    near = _SAME * float(np.ptp(every, axis=0).max())
    if not 0.0 < near < math.inf or float(np.abs(every).max()) * scale > LARGEST:
        raise ValueError(f"a solid of some length within {LARGEST:g} m of the origin")
    along = _direction(found, near, scale)
    heights = every @ along
    across = _across(along)
    ends = [
        _loops(
            [face for face in _ends(found, along) if _is_at(face, along, place, near)],
            across,
            scale,
        )
        for place in (heights.min(), heights.max())
    ]
    shapes = [_size(loops) for loops in ends]
    if not all(math.isclose(*pair, rel_tol=_ALIKE) for pair in zip(*shapes)):
        areas = " and ".join(f"{1e6 * area:.6g} mm2" for area, _ in shapes)
        raise ValueError(f"an extrusion; its ends have {areas}; {WAY_OUT}")
    return Drawn(ends[1], round(scale * float(np.ptp(heights)), _DIGITS))


def _direction(found: Solid, near: float, scale: float) -> np.ndarray:
    """Unit vector along which the solid is an extrusion that is longer than wide."""
    each = _different(face.direction for face in found.faces if face.direction is not None)
    if not len(each):
        raise ValueError(f"an extrusion, with planes at its ends; {WAY_OUT}")
    every = np.concatenate([face.points() for face in found.faces])
    words: list[str] = []
    for along in each:
        size = np.ptp(every @ np.array([along, *_across(along)]).T, axis=0)
        if not _is_along(found, along) or _fault(found, along, near, scale) is not None:
            continue
        if size[0] > size[1:].max() + near:
            return along
        length, *width = (f"{1e3 * scale * place:.4g}" for place in size)
        words = [  # a plate with holes is an extrusion along its holes
            f"as one it is {length} mm long with a section of {' x '.join(width)} mm, where a rail "
            "is longer than wide"
        ]
    longest = max(each, key=lambda along: _edges_along(found, along))
    if fault := _fault(found, longest, near, scale):
        words.insert(0, fault)
    raise ValueError(f"an extrusion; {'; '.join(words)}; {WAY_OUT}")


def _different(given: Iterable[np.ndarray]) -> np.ndarray:
    """Directions (n,3), one of those that are parallel, towards the positive side of the nearest axis."""
    found = np.empty((0, 3))
    for each in given:
        if not _is_parallel(found, each).any():
            found = np.vstack([found, np.copysign(1.0, each[np.abs(each).argmax()]) * each])
    return found


def _is_parallel(several: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Which of ``several`` directions (...,3) are parallel to one."""
    return np.linalg.norm(np.cross(several, along), axis=-1) < _ANGLE


def _is_along(found: Solid, along: np.ndarray) -> bool:
    """Whether each face may be a side or an end of an extrusion along a direction."""
    if any(face.direction is None for face in found.faces):
        return False
    every = np.array([face.direction for face in found.faces])
    plane = np.array([face.surface == "PLANE" for face in found.faces])
    return bool((_is_parallel(every, along) | (plane & (np.abs(every @ along) < _ANGLE))).all())


def _edges_along(found: Solid, along: np.ndarray) -> float:
    """Length of all straight edges along a direction."""
    vectors = np.array([edge.ends[1] - edge.ends[0] for face in found.faces for edge in face.edges])
    lengths = np.linalg.norm(vectors, axis=1)
    return float(lengths[np.linalg.norm(np.cross(vectors, along), axis=1) < _ANGLE * lengths].sum())


def _fault(found: Solid, along: np.ndarray, near: float, scale: float) -> str | None:
    """Why the solid is no extrusion along a direction: the first face that is none of its sides and
    ends."""
    every = np.concatenate([face.points() for face in found.faces]) @ along
    low, high = float(every.min()), float(every.max())
    for face in found.faces:
        heights = face.points() @ along
        places = [place for edge in face.edges for place in edge.span(along)]
        span = [f"{1e3 * scale * (place - low):.4g}" for place in (min(places), max(places))]
        where = f"from {span[0]} to {span[1]} mm of its {1e3 * scale * (high - low):.4g} mm"
        if face.direction is None:
            return f"a face is on a {face.surface}, {where}"
        is_plane, lean = face.surface == "PLANE", abs(float(face.direction @ along))
        if (is_plane and lean < _ANGLE) or (not is_plane and _is_parallel(face.direction, along)):
            continue
        if not is_plane:
            words = f"a cylinder of radius {1e3 * scale * face.radius:.4g} mm"
            return f"{words if face.radius else 'an extruded curve'} is not along it, {where}"
        if not _is_parallel(face.direction, along):
            angle = math.degrees(math.asin(min(1.0, lean)))
            return f"a plane leans by {angle:.3g} degrees, {where}"
        if min(abs(heights[0] - low), abs(heights[0] - high)) > near:
            return f"its section changes {span[0]} mm from one end, of {where.split(' of its ')[1]}"
    return None


def _ends(found: Solid, along: np.ndarray) -> list[Face]:
    return [
        face
        for face in found.faces
        if face.surface == "PLANE"
        and face.direction is not None
        and _is_parallel(face.direction, along)
    ]


def _is_at(face: Face, along: np.ndarray, place: float, near: float) -> bool:
    return abs(float(face.points()[0] @ along) - place) <= near


def _across(along: np.ndarray) -> np.ndarray:
    """Axes (2,3) of the section, Y and Z, in the axes of the file."""
    nearest = int(np.abs(along).argmax())
    axis = np.eye(3)[nearest]
    turn, cosine = np.cross(axis, along), float(axis @ along)
    others = np.eye(3)[[(nearest + 1) % 3, (nearest + 2) % 3]]
    # Rodrigues' formula for the smallest rotation, whose axis is the product of both
    return np.array(
        [
            cosine * each + np.cross(turn, each) + turn * float(turn @ each) / (1.0 + cosine)
            for each in others
        ]
    )


def _loops(faces: list[Face], across: np.ndarray, scale: float) -> list[list[Corner]]:
    """Corners (m) of the borders of faces in one plane."""
    times = Counter(edge.number for face in faces for edge in face.edges)
    borders = {
        edge.number: edge for face in faces for edge in face.edges if times[edge.number] == 1
    }
    if not borders:
        raise ValueError(f"an extrusion with planes at both ends; {WAY_OUT}")
    found = closed_loops([_path(edge, across) for edge in borders.values()], [], scale)
    return [[(round(y, _DIGITS) + 0.0, round(z, _DIGITS) + 0.0) for y, z in loop] for loop in found]


def _path(edge: Edge, across: np.ndarray) -> Polyline:
    """The ends of a border, and the middle of an arc of more than half a circle."""
    start, end = ((float(y), float(z)) for y, z in edge.ends @ across.T)
    if edge.curve == "LINE":
        return [(*start, 0.0), (*end, 0.0)]
    if edge.curve != "CIRCLE" or edge.centre is None or edge.axis is None:
        raise ValueError(f"a section of lines and arcs; it has a {edge.curve}; {WAY_OUT}")
    left = float(np.cross(*across) @ edge.axis) > 0.0
    y, z = (float(place) for place in across @ edge.centre)
    begin, stop = (math.atan2(point[1] - z, point[0] - y) for point in (start, end))
    sweep = (stop - begin if left else begin - stop) % (2.0 * math.pi)
    if math.dist(start, end) < _ANGLE * math.dist(start, (y, z)):
        sweep = 2.0 * math.pi
    half, sign, radius = 0.5 * sweep, 1.0 if left else -1.0, math.dist(start, (y, z))
    if half <= 0.5 * math.pi:
        return [(*start, sign * math.tan(0.5 * half)), (*end, 0.0)]
    middle = begin + sign * half
    place = (y + radius * math.cos(middle), z + radius * math.sin(middle))
    bulge = sign * math.tan(0.25 * half)
    return [(*start, bulge), (*place, bulge), (*end, 0.0)]


def _size(loops: list[list[Corner]]) -> tuple[float, float]:
    """Area (m2) and length of all borders (m)."""
    found = outline(loops)
    return found.moments().area, sum(math.dist(*side) for side in found.sides())


FORMATS = (
    Format(
        "STEP",
        read_step,
        [("STEP, `.step`, `.stp`", "the section of an extruded solid")],
        suffixes=(".step", ".stp"),
    ),
)
