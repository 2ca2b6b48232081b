"""A solid from a CAD file (STEP, IGES, BREP) as hexahedra or as quadratic tetrahedra, made with
gmsh.

A solid whose faces are all plane and parallel to the axes is a set of bricks: the planes of its
faces divide space into cells, and each is metal or not. A solid with a constant section along X is
an extrusion of this section, meshed in quadrilaterals. Any other solid is filled with tetrahedra of
twice the element size, each split into four hexahedra at the centres of its edges and faces. Such
elements are skewed: the step becomes shorter and thin walls too stiff. Quadratic tetrahedra, on
request, have ten nodes, about ``element_size`` apart, and edges that follow curved faces. Boxes
that name parts of the faces are drawn onto them (``meshes.imprint``).
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.meshes import bricks, generator, iges, imprint, layers
from tipoff.meshes.tetrahedra import Cost, filled

_SAME = 1e-9  # m; planes closer than this are one
_TIE = 1e-6  # divisions
_PROBES = 9  # points of an edge at which its curvature is tested


class Meshed(NamedTuple):
    """Elements of a solid."""

    points: np.ndarray  # (n,3) m
    cells: np.ndarray  # (e,8) hexahedra or (e,10) tetrahedra, VTK order
    areas: dict[str, float]  # m2 of the faces of the solid in the boxes of each surface


class Filling(NamedTuple):
    """Options for solids that are neither bricks nor extrusions."""

    tetrahedra: bool = False  # False: each is split into four hexahedra; True: also for bricks
    cost: Cost = lambda points, cells: 0.0  # of a mesh; the lowest one is taken
    enough: float = 0.0  # cost below which no other mesh is tried
    # raises for a volume (m3) that is too large to mesh
    fits: Callable[[float], None] = lambda volume: None


_HEXAHEDRA = Filling()


def build(
    path: Path, element_size: float, boxes: imprint.Boxes, filling: Filling = _HEXAHEDRA
) -> Meshed:
    """Elements about ``element_size`` (m) of every solid in a file of any length unit, with the
    borders of the ``boxes`` between elements.

    Raises ValueError for a file without a solid that gmsh can read, imprint.Outside for boxes
    without a face, GmshUnavailable if gmsh does not load, and the errors of ``filling.fits``.
    """
    with generator.session("solid") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "M")
        try:
            if path.suffix.lower() in iges.SUFFIXES:
                iges.load(gmsh, path)
            else:
                gmsh.model.occ.importShapes(str(path))
            gmsh.model.occ.removeAllDuplicates()  # solids that touch share the face between them
            gmsh.model.occ.synchronize()
        except ValueError:
            raise
        except Exception as fault:  # gmsh knows no other class
            raise ValueError(f"gmsh does not read it ({fault})") from fault
        if not gmsh.model.getEntities(3):
            raise ValueError("it holds no solid")
        try:
            areas = imprint.areas(gmsh, boxes)
            volume = sum(gmsh.model.occ.getMass(*solid) for solid in gmsh.model.getEntities(3))
        except imprint.Outside:
            raise
        except Exception as fault:  # gmsh knows no other class
            raise ValueError(f"gmsh cannot measure its faces ({fault})") from fault
        filling.fits(volume)
        try:
            return Meshed(*_elements(gmsh, element_size, boxes, filling), areas)
        except Exception as fault:  # gmsh knows no other class
            raise ValueError(
                f"gmsh cannot fill it with elements of {element_size:g} m ({fault})"
            ) from fault


def _elements(
    gmsh, element_size: float, boxes: imprint.Boxes, filling: Filling
) -> tuple[np.ndarray, np.ndarray]:
    every = [box for given in boxes.values() for box in given]
    planes = np.reshape(every, (-1, 3))
    if not filling.tetrahedra and _is_bricks(gmsh):
        volumes = [tag for _, tag in gmsh.model.getEntities(3)]
        return _bricks(gmsh, volumes, element_size, planes)
    if not filling.tetrahedra and _is_extruded(gmsh):
        return _extruded(gmsh, element_size, every)
    faces = [tag for _, tag in gmsh.model.getEntities(2)]
    imprint.draw(gmsh, every, [faces] * len(every))
    return filled(gmsh, element_size, not filling.tetrahedra, filling.cost, filling.enough)


def _vertices(gmsh, dimension: int, tag: int) -> np.ndarray:
    """Corners (v,3) m of an entity, of all entities of the dimension for tag -1."""
    entities = gmsh.model.getEntities(dimension) if tag == -1 else [(dimension, tag)]
    ends = gmsh.model.getBoundary(entities, combined=False, recursive=True)
    return np.array([gmsh.model.getValue(0, point, []) for _, point in ends])


def _is_bricks(gmsh) -> bool:
    straight = all(gmsh.model.getType(1, tag) == "Line" for _, tag in gmsh.model.getEntities(1))
    return straight and all(
        (np.ptp(_vertices(gmsh, 2, tag), axis=0) < _SAME).any()
        for _, tag in gmsh.model.getEntities(2)
    )


def _bricks(
    gmsh, volumes: list[int], element_size: float, planes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Cells between all planes, inside a solid; each interval has about length / element_size
    divisions, at least one."""
    corners = _vertices(gmsh, 3, -1)
    lines = [_different(corners[:, axis], planes[:, axis]) for axis in range(3)]
    middles = [0.5 * (line[1:] + line[:-1]) for line in lines]
    metal = np.zeros([len(middle) for middle in middles], dtype=bool)
    for cell in np.ndindex(metal.shape):
        place = [float(middle[i]) for middle, i in zip(middles, cell)]
        metal[cell] = any(gmsh.model.isInside(3, volume, place) for volume in volumes)
    for axis, line in enumerate(lines):
        metal = np.repeat(metal, _divisions(line, element_size), axis=axis)
    return bricks.filled([_divided(line, element_size) for line in lines], metal)


def _different(solid: np.ndarray, requested: np.ndarray) -> np.ndarray:
    """Positions of the solid's planes and of the requested ones inside it, in order, without
    duplicates."""
    inside = (requested > solid.min()) & (requested < solid.max())
    places = np.sort(np.concatenate([solid, requested[inside]]))
    return places[np.append(True, np.diff(places) > _SAME)]


def _divisions(line: np.ndarray, element_size: float) -> np.ndarray:
    """Elements in each interval. Halves are rounded down for any rounding of positions, so that
    symmetric solids get symmetric meshes."""
    return np.maximum(1, np.ceil(np.diff(line) / element_size - 0.5 - _TIE).astype(int))


def _divided(line: np.ndarray, element_size: float) -> np.ndarray:
    """All borders of elements along a line of places."""
    return bricks.divided(line, _divisions(line, element_size))


def _is_extruded(gmsh) -> bool:
    """Whether every edge runs along X from one end to the other, or lies in an end plane."""
    x = _vertices(gmsh, 3, -1)[:, 0]
    for _, edge in gmsh.model.getEntities(1):
        low, high = np.array(gmsh.model.getParametrizationBounds(1, edge)).ravel()
        along = np.array(gmsh.model.getValue(1, edge, np.linspace(low, high, _PROBES))).reshape(
            -1, 3
        )
        across = np.ptp(along, axis=0)
        in_end = across[0] < _SAME and np.abs(along[0, 0] - [x.min(), x.max()]).min() < _SAME
        from_end_to_end = across[1:].max() < _SAME and abs(across[0] - np.ptp(x)) < _SAME
        if not (in_end or from_end_to_end):
            return False
    return True


def _extruded(gmsh, element_size: float, boxes: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    planes = np.reshape(boxes, (-1, 3))
    x = _different(_vertices(gmsh, 3, -1)[:, 0], planes[:, 0])
    stations = _divided(x, element_size)
    _draw_on_section(gmsh, boxes, x[[0, -1]])
    ends = _faces_at(gmsh, x[0])
    # halves every side, so that no triangle remains
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1)
    section, quads = layers.quadrilaterals(gmsh, 2.0 * element_size, ends)
    return layers.extruded(section, quads, stations)


def _draw_on_section(gmsh, boxes: list[np.ndarray], ends: np.ndarray) -> None:
    """Draw the borders of ``boxes`` onto an extrusion from one of its ``ends`` (2,) m to the other;
    its end face gets the borders of boxes that reach an end."""
    first = _faces_at(gmsh, ends[0])
    sides = [
        tag
        for _, tag in gmsh.model.getEntities(2)
        if tag not in (*first, *_faces_at(gmsh, ends[1]))
    ]
    whole, faces = [], []
    for box in boxes:
        reaches = box[0, 0] < ends[0] + imprint.SAME or box[1, 0] > ends[1] - imprint.SAME
        faces.append(sides + first if reaches else sides)
        whole.append(np.array([[ends[0] - 1.0, *box[0, 1:]], [ends[1] + 1.0, *box[1, 1:]]]))
    imprint.draw(gmsh, whole, faces)


def _faces_at(gmsh, x: float) -> list[int]:
    """Faces in the plane at ``x`` (m)."""
    return [
        tag
        for _, tag in gmsh.model.getEntities(2)
        if np.abs(_vertices(gmsh, 2, tag)[:, 0] - x).max() < _SAME
    ]
