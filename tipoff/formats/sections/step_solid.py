"""The solid in a STEP file: its faces and edges, and the unit of its lengths.

Planes and cylinders are read, lines and circles; other surfaces and curves keep their name. Points and
lengths are in the unit of the file.

Source: ISO 10303-42 (geometry and topology), -41 (units), -43 (assemblies).
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tipoff.formats.sections.part21 import Instances, Reference, value

WAY_OUT = "give such a rail as a solid, [rail] geometry"
_MOST_FACES = 1000
_SAME = 1e-9  # of directions, and of the places of an assembly over their distance
_CURVES_ON_SURFACES = ("SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE")
_PREFIXES = {"": 0, "KILO": 3, "DECI": -1, "CENTI": -2, "MILLI": -3, "MICRO": -6}
_MADE_OF_FACETS = ("FACETED_BREP", "TESSELLATED_SOLID", "TESSELLATED_SHELL")
_SOLIDS = ("MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", *_MADE_OF_FACETS)


class Edge(NamedTuple):
    """A line or an arc between two points; another curve by its name."""

    number: int  # of its instance
    ends: np.ndarray  # (2,3)
    curve: str  # LINE, CIRCLE or another
    centre: np.ndarray | None = None  # (3,) of a circle
    axis: np.ndarray | None = None  # (3,) about which it turns to the left from start to end

    def span(self, along: np.ndarray) -> list[float]:
        """Least and largest place along a direction, of the ends or of a whole circle."""
        places = self.ends @ along
        if (
            self.centre is not None
            and self.axis is not None
            and (self.ends[0] == self.ends[1]).all()
        ):
            reach = math.dist(self.ends[0], self.centre) * math.hypot(*np.cross(self.axis, along))
            places = float(self.centre @ along) + np.array([-reach, reach])
        return [float(places.min()), float(places.max())]


class Face(NamedTuple):
    """A face on a plane or a cylinder; on another surface, by its name."""

    surface: str  # PLANE, CYLINDRICAL_SURFACE, SURFACE_OF_LINEAR_EXTRUSION or another
    direction: np.ndarray | None  # (3,) normal of a plane, axis of a cylinder
    radius: float  # of a cylinder, else 0
    edges: tuple[Edge, ...]

    def points(self) -> np.ndarray:
        """Ends (n,3) of its edges."""
        return np.concatenate([edge.ends for edge in self.edges])


class Solid(NamedTuple):
    """The faces of a solid."""

    faces: tuple[Face, ...]
    unit: float | None  # m; None if the file states none


def read_solid(path: str | Path) -> Solid:
    """The only solid of a file. Raises OSError, and ValueError with what the file lacks."""
    file = Instances(path)
    number, values = _only_solid(file)
    _require_own_axes(file)
    shells = file.instance(value(values, 1, Reference))
    shell = shells.get("CLOSED_SHELL") or shells.get("OPEN_SHELL") or []
    faces = value(shell, 1, list)
    if len(faces) > _MOST_FACES:
        raise ValueError(f"at most {_MOST_FACES} faces, not {len(faces)}")
    known: dict[int, Edge] = {}
    return Solid(tuple(_face(file, face, known) for face in faces), _unit(file, number))


def _only_solid(file: Instances) -> tuple[Reference, list]:
    found = list(file.named(*_SOLIDS))
    if not found:
        surfaces = any(file.named("SHELL_BASED_SURFACE_MODEL", "ADVANCED_FACE"))
        raise ValueError(
            f"a solid; the file has {'surfaces that enclose none' if surfaces else 'none'}"
        )
    if len(found) > 1:
        names = [str(values[0]) if values and values[0] else "unnamed" for _, values in found]
        raise ValueError(f"one solid; the file has {len(found)}: {', '.join(names[:8])}; {WAY_OUT}")
    number, values = found[0]
    kind = next(name for name in _SOLIDS if name in file.instance(number))
    if kind == "BREP_WITH_VOIDS":
        raise ValueError(f"an extrusion; the solid has a closed cavity; {WAY_OUT}")
    if kind in _MADE_OF_FACETS:
        raise ValueError(f"a solid of planes and cylinders, not one of facets ({kind})")
    return number, values


def _require_own_axes(file: Instances) -> None:
    """Raise ValueError if an assembly moves its parts: the section would have other axes."""
    moved = any(file.named("MAPPED_ITEM"))
    for _, values in file.named("ITEM_DEFINED_TRANSFORMATION"):
        one, two = (_placement(file, value(values, place, Reference)) for place in (2, 3))
        scale = _SAME * max(1.0, float(np.abs([one[0], two[0]]).max()))
        moved |= bool((np.abs(one[0] - two[0]) > scale).any())
        moved |= bool((np.abs(one[1] - two[1]) > _SAME).any())
    if moved:
        raise ValueError("a part in its own axes; this file has an assembly that moves it")


def _face(file: Instances, number: Any, known: dict[int, Edge]) -> Face:
    faces = file.instance(number)
    values = faces.get("ADVANCED_FACE") or faces.get("FACE_SURFACE") or []
    surface = file.instance(value(values, 2, Reference))
    edges = []
    for bound in value(values, 1, list):
        bounds = file.instance(bound)
        loop = bounds.get("FACE_BOUND") or bounds.get("FACE_OUTER_BOUND") or []
        loops = file.instance(value(loop, 1, Reference))
        for each in value(loops.get("EDGE_LOOP", [[], []]), 1, list):
            oriented = file.instance(each).get("ORIENTED_EDGE", [])
            edges.append(_edge(file, value(oriented, 3, Reference), known))
    direction, radius = None, 0.0
    name = _name(surface)
    if not edges:
        raise ValueError(f"an extrusion; a face is a whole {name}, without edges; {WAY_OUT}")
    if name in ("PLANE", "CYLINDRICAL_SURFACE"):
        _, axes = _placement(file, value(surface[name], 1, Reference))
        direction = axes[2]
        radius = value(surface[name], 2, float) if name != "PLANE" else 0.0
    elif name == "SURFACE_OF_LINEAR_EXTRUSION":
        vector = file.instance(value(surface[name], 2, Reference)).get("VECTOR", [])
        direction = _direction(file, value(vector, 1, Reference))
    return Face(name, direction, radius, tuple(edges))


def _edge(file: Instances, number: Reference, known: dict[int, Edge]) -> Edge:
    if number not in known:
        values = file.instance(number).get("EDGE_CURVE", [])
        ends = np.array([_vertex(file, value(values, place, Reference)) for place in (1, 2)])
        curve = file.instance(value(values, 3, Reference))
        for name in _CURVES_ON_SURFACES:
            if name in curve:
                curve = file.instance(value(curve[name], 1, Reference))
        name, centre, axis = _name(curve), None, None
        if name == "CIRCLE":
            centre, axes = _placement(file, value(curve[name], 1, Reference))
            axis = axes[2] if value(values, 4, str) == ".T." else -axes[2]
        known[number] = Edge(number, ends, name, centre, axis)
    return known[number]


def _name(found: dict[str, list]) -> str:
    """Name of a surface or a curve; a spline has several types at once."""
    return next((name for name in found if "SPLINE" in name), next(iter(found), "nothing"))


def _vertex(file: Instances, number: Reference) -> np.ndarray:
    return _point(file, value(file.instance(number).get("VERTEX_POINT", []), 1, Reference))


def _point(file: Instances, number: Reference) -> np.ndarray:
    return _three(file.instance(number).get("CARTESIAN_POINT", []))


def _direction(file: Instances, number: Reference) -> np.ndarray:
    found = _three(file.instance(number).get("DIRECTION", []))
    length = math.hypot(*found)
    if not 0.0 < length < math.inf:
        raise ValueError(f"a whole STEP file; the direction #{number:d} has no length")
    return found / length


def _three(values: list) -> np.ndarray:
    numbers = value(values, 1, list)
    return np.array([value(numbers, place, float) for place in range(3)])


def _placement(file: Instances, number: Reference) -> tuple[np.ndarray, np.ndarray]:
    """Origin (3,) and axes (3,3), a row each."""
    values = file.instance(number).get("AXIS2_PLACEMENT_3D", [])
    origin = _point(file, value(values, 1, Reference))
    third = _given_or(file, values[2:3], (0.0, 0.0, 1.0))
    other = (1.0, 0.0, 0.0) if abs(third[0]) < 0.9 else (0.0, 1.0, 0.0)
    first = _given_or(file, values[3:4], other)
    second = np.cross(third, first)
    if (length := math.hypot(*second)) < _SAME:
        raise ValueError(f"a whole STEP file; the axes of #{number:d} are parallel")
    second /= length
    return origin, np.array([np.cross(second, third), second, third])


def _given_or(file: Instances, given: list, other: Sequence[float]) -> np.ndarray:
    return (
        np.array(other) if given in ([], [None]) else _direction(file, value(given, 0, Reference))
    )


def _unit(file: Instances, number: Reference) -> float | None:
    """Metres in the unit of length of the representation that has a solid; None without one."""
    for _, values in file.named("ADVANCED_BREP_SHAPE_REPRESENTATION", "SHAPE_REPRESENTATION"):
        if number in value(values, 1, list):
            context = file.instance(value(values, 2, Reference))
            units = context.get("GLOBAL_UNIT_ASSIGNED_CONTEXT", [[]])
            for unit in value(units, 0, list):
                if "LENGTH_UNIT" in file.instance(unit):
                    return _metres(file, unit, ())
    return None


def _metres(file: Instances, number: Any, chain: tuple[int, ...]) -> float:
    found = file.instance(number)
    if "SI_UNIT" in found:
        prefix, name = (str(each or "").strip(".") for each in (found["SI_UNIT"] + [None] * 2)[:2])
        if name == "METRE" and prefix in _PREFIXES:
            return 10.0 ** _PREFIXES[prefix]
    if "CONVERSION_BASED_UNIT" in found and number not in chain:
        measure = file.instance(value(found["CONVERSION_BASED_UNIT"], 1, Reference))
        values = next(iter(measure.values()), [])
        scale = value(values, 0, float)
        if 1e-9 < scale < 1e9:
            return scale * _metres(file, value(values, 1, Reference), (*chain, number))
    raise ValueError(f"a unit of length in the STEP file; #{number:d} is none")
