"""Four L-section launch rails as structured hexahedra, made with gmsh.

Scene frame: SI, origin at the payload mass centre at t = 0, +X to the open end. One rail stands at each corner
(sign_y, sign_z) = (+-1, +-1). Its outer corner edge is at |y| = inner_corner_y + thickness, |z| = inner_corner_z + thickness,
and its inner walls |y| = inner_corner_y and |z| = inner_corner_z face the payload.

gmsh meshes the rail of the (+,+) corner only. The other three are that mesh with signs changed, so that the four are mirror
images bit for bit and a symmetric scene has a symmetric answer; their elements are then numbered along the axes again,
which restores the orientation that a reflection reverses.
"""

import itertools
import math
from typing import NamedTuple

import meshio
import numpy as np

from meshes import generator, msh

SURFACES = ("contact_y", "contact_z", "mount")

_CORNERS = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
# Position in the VTK corner order of the corner with axis bits x + 2 y + 4 z (bit set: on the larger side).
_VTK_POSITION = np.array([0, 1, 3, 2, 4, 5, 7, 6])
_TOUCH = 1e-9  # m: two coordinates closer than this are the same plane
_EVEN = 0.1  # of the element size: layers all along the rail have one length where that length is no further from it


class LRailGeometry(NamedTuple):
    """Dimensions in metres; `mount_spans` are measured from the rear end of the rail, `mount_width` from its outer corner."""

    leg: float = 0.024
    thickness: float = 0.004
    x_start: float = -0.088
    x_end: float = 0.132
    inner_corner_y: float = 0.10025
    inner_corner_z: float = 0.10025
    mount_spans: tuple[tuple[float, float], ...] = ((0.008, 0.028), (0.100, 0.120), (0.192, 0.212))
    mount_width: float = 0.004


def build(geometry: LRailGeometry, element_size: float) -> meshio.Mesh:
    """Mesh the four rails; every border of a mount and of a wall lies on a grid plane, whatever the element size.

    Each interval between borders gets round(length / element_size) divisions, one at least; along X all layers have the same length
    where one near the element size divides every interval, since an even extrusion is solved several times faster. With the default
    geometry all elements are cubes for sizes of 4, 2 and 1 mm.

    Returns a mesh with one `hexahedron` block (volume `rail`) and one `quad` block per surface in `SURFACES`, numbered from 0
    and tagged with the field `gmsh:physical`.
    Raises ValueError for dimensions that do not make a rail, RuntimeError where a system library of gmsh is missing.
    """
    _check(geometry, element_size)
    with generator.session("l_rail") as gmsh:
        _draw(gmsh, geometry, element_size)
        points, hexes, surfaces = _extract(gmsh)
    return msh.tagged(*_mirrored(points, hexes, surfaces))


def elements(geometry: LRailGeometry, element_size: float) -> int:
    """Elements that ``build`` would make, without making them. Raises ValueError as it does."""
    _check(geometry, element_size)
    depths, stations = _depths(geometry), _stations(geometry)
    layer, across = _layer_length(stations, element_size), [_divisions(b - a, element_size) for a, b in itertools.pairwise(depths)]
    section = sum(across[i] * across[j] for i, j in _section(geometry, depths))
    return len(_CORNERS) * section * sum(_divisions(end - start, layer) for start, end in itertools.pairwise(stations))


def _depths(geometry: LRailGeometry) -> list[float]:
    """Grid lines of the section, measured inwards from the outer corner along y and along z."""
    return _grid_lines(0.0, geometry.thickness, geometry.mount_width, geometry.leg)


def _stations(geometry: LRailGeometry) -> list[float]:
    """Grid planes along X (m)."""
    return _grid_lines(geometry.x_start, geometry.x_end,
                       *(geometry.x_start + border for span in geometry.mount_spans for border in span))


def _section(geometry: LRailGeometry, depths: list[float]) -> list[tuple[int, int]]:
    """Intervals of depth along y and along z whose rectangles lie inside the L."""
    return [(i, j) for i, j in itertools.product(range(len(depths) - 1), repeat=2)
            if min(depths[i], depths[j]) < geometry.thickness - _TOUCH]


def _check(geometry: LRailGeometry, element_size: float) -> None:
    length = geometry.x_end - geometry.x_start
    borders = [0.0, *itertools.chain.from_iterable(geometry.mount_spans), length]
    if not 0.0 < element_size:
        raise ValueError(f"element_size must be positive, got {element_size!r}")
    if not 0.0 < geometry.mount_width <= geometry.leg or not 0.0 < geometry.thickness < geometry.leg:
        raise ValueError(f"need 0 < thickness < leg and 0 < mount_width <= leg, got {geometry}")
    if any(right < left for left, right in itertools.pairwise(borders)) or length <= 0.0:
        raise ValueError(f"mount_spans must be in order and inside the length {length:g} m, got {geometry.mount_spans}")


def _grid_lines(*borders: float) -> list[float]:
    """The borders in order, those that coincide taken once."""
    lines = sorted(borders)
    return lines[:1] + [right for left, right in itertools.pairwise(lines) if right - left > _TOUCH]


def _layer_length(stations: list[float], element_size: float) -> float:
    """Length (m) that divides every interval between stations and is close to the element size; where there is none, that size."""
    common = math.gcd(*(round((right - left) / _TOUCH) for left, right in itertools.pairwise(stations))) * _TOUCH
    even = common / _divisions(common, element_size)
    return even if abs(even - element_size) <= _EVEN * element_size else element_size


def _divisions(length: float, element_size: float) -> int:
    return max(1, round(length / element_size))


def _draw(gmsh, geometry: LRailGeometry, element_size: float) -> None:
    """Mesh one rail: a section of rectangles, extruded interval by interval so that the mounts are surfaces of their own."""
    depths, stations = _depths(geometry), _stations(geometry)
    section = _draw_section(gmsh, geometry, depths, element_size)
    layer = _layer_length(stations, element_size)
    for start, end in itertools.pairwise(stations):
        made = gmsh.model.geo.extrude([(2, surface) for surface in section], end - start, 0.0, 0.0,
                                      numElements=[_divisions(end - start, layer)], recombine=True)
        # gmsh lists, for each surface extruded, its far copy, then the volume, then the sides.
        section = [tag for (_, tag), (dimension, _) in itertools.pairwise(made) if dimension == 3]
    gmsh.model.geo.synchronize()
    _name_surfaces(gmsh, geometry)
    gmsh.model.mesh.generate(3)


def _draw_section(gmsh, geometry: LRailGeometry, depths: list[float], element_size: float) -> list[int]:
    """Rectangles between `depths`, measured inwards from the outer corner along y and z, that lie inside the L."""
    geo = gmsh.model.geo
    outer_y, outer_z = geometry.inner_corner_y + geometry.thickness, geometry.inner_corner_z + geometry.thickness
    cells = _section(geometry, depths)
    corners = sorted({(i + di, j + dj) for i, j in cells for di, dj in itertools.product((0, 1), repeat=2)})
    point = {(i, j): geo.addPoint(geometry.x_start, outer_y - depths[i], outer_z - depths[j]) for i, j in corners}
    line = {}
    for i, j in corners:
        for following, interval in (((i + 1, j), i), ((i, j + 1), j)):
            if following in point:
                line[(i, j), following] = tag = geo.addLine(point[i, j], point[following])
                count = _divisions(depths[interval + 1] - depths[interval], element_size)
                geo.mesh.setTransfiniteCurve(tag, count + 1)
    section = []
    for i, j in cells:
        loop = geo.addCurveLoop([line[(i, j), (i + 1, j)], line[(i + 1, j), (i + 1, j + 1)],
                                 -line[(i, j + 1), (i + 1, j + 1)], -line[(i, j), (i, j + 1)]])
        section.append(geo.addPlaneSurface([loop]))
        geo.mesh.setTransfiniteSurface(section[-1])
        geo.mesh.setRecombine(2, section[-1])
    return section


def _name_surfaces(gmsh, geometry: LRailGeometry) -> None:
    """Physical groups of the (+,+) rail, found as the surfaces that fill a flat box."""
    g = geometry
    outer_y, outer_z = g.inner_corner_y + g.thickness, g.inner_corner_z + g.thickness
    boxes = {
        "contact_y": [((g.x_start, g.inner_corner_y, outer_z - g.leg), (g.x_end, g.inner_corner_y, g.inner_corner_z))],
        "contact_z": [((g.x_start, outer_y - g.leg, g.inner_corner_z), (g.x_end, g.inner_corner_y, g.inner_corner_z))],
        "mount": [box for start, end in g.mount_spans for box in (
            ((g.x_start + start, outer_y, outer_z - g.mount_width), (g.x_start + end, outer_y, outer_z)),
            ((g.x_start + start, outer_y - g.mount_width, outer_z), (g.x_start + end, outer_y, outer_z)))],
    }
    for tag, name in enumerate(SURFACES, start=1):
        entities = [surface for low, high in boxes[name] for _, surface in gmsh.model.getEntitiesInBoundingBox(
            *(value - _TOUCH for value in low), *(value + _TOUCH for value in high), dim=2)]
        gmsh.model.addPhysicalGroup(2, entities, tag, name)


def _extract(gmsh):
    """Points (n,3), hexes (e,8) and facets per surface of the meshed model, numbered from 0."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))

    def elements(dimension, entities, corners):
        nodes = [gmsh.model.mesh.getElements(dimension, entity)[2][0] for entity in entities]
        return number[np.concatenate(nodes).astype(np.int64)].reshape(-1, corners)

    hexes = elements(3, [tag for _, tag in gmsh.model.getEntities(3)], 8)
    surfaces = {name: elements(2, gmsh.model.getEntitiesForPhysicalGroup(2, tag), 4)
                for tag, name in enumerate(SURFACES, start=1)}
    return coordinates.reshape(-1, 3), hexes, surfaces


def _mirrored(points, hexes, surfaces):
    """One rail per corner of the launcher, their elements numbered alike (see the module docstring)."""
    count = len(points)
    all_points = np.concatenate([points * (1, sign_y, sign_z) for sign_y, sign_z in _CORNERS])
    all_hexes = np.concatenate([hexes + rail * count for rail in range(len(_CORNERS))])
    all_surfaces = {name: np.concatenate([facets + rail * count for rail in range(len(_CORNERS))])
                    for name, facets in surfaces.items()}
    return all_points, _along_axes(all_points, all_hexes), all_surfaces


def _along_axes(points, hexes):
    """Number the corners of axis-parallel bricks in VTK order along +x, +y, +z: translated bricks are then equal."""
    corners = points[hexes]
    upper = corners > corners.mean(axis=1, keepdims=True)
    ordered = np.empty_like(hexes)
    np.put_along_axis(ordered, _VTK_POSITION[upper @ (1, 2, 4)], hexes, axis=1)
    return ordered
