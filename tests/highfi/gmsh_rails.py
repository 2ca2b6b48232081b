"""The built-in L rails as gmsh meshes them: rectangles with transfinite sides, recombined to
quadrilaterals and extruded in layers.

It shares the choice of grid lines and divisions with `meshes.l_rail`, and neither the placing of
nodes, nor the elements, nor how surfaces are found.
"""

import itertools

import numpy as np

from tipoff.meshes import generator
from tipoff.meshes.l_rail import (
    SURFACES,
    LRailGeometry,
    divisions,
    grid_depths,
    grid_stations,
    layer_length,
    section_cells,
)

_TOUCH = 1e-9  # m


def corner_rail(geometry: LRailGeometry, element_size: float):
    """Points (n,3), hexes (e,8) and facets (m,4) per surface of the rail of the (+,+) corner.
    Raises GmshUnavailable."""
    with generator.session("l_rail") as gmsh:
        _draw(gmsh, geometry, element_size)
        return _extract(gmsh)


def _draw(gmsh, geometry: LRailGeometry, element_size: float) -> None:
    """Mesh one rail: a section of rectangles, extruded interval by interval so that the mounts are
    surfaces of their own."""
    depths, stations = grid_depths(geometry), grid_stations(geometry)
    section = _draw_section(gmsh, geometry, depths, element_size)
    layer = layer_length(stations, element_size)
    for start, end in itertools.pairwise(stations):
        made = gmsh.model.geo.extrude(
            [(2, surface) for surface in section],
            end - start,
            0.0,
            0.0,
            numElements=[divisions(end - start, layer)],
            recombine=True,
        )
        # gmsh lists, for each surface extruded, its far copy, then the volume, then the sides.
        section = [tag for (_, tag), (dimension, _) in itertools.pairwise(made) if dimension == 3]
    gmsh.model.geo.synchronize()
    _name_surfaces(gmsh, geometry)
    gmsh.model.mesh.generate(3)


def _draw_section(
    gmsh, geometry: LRailGeometry, depths: list[float], element_size: float
) -> list[int]:
    """Rectangles between `depths`, measured inwards from the outer corner along y and z, that lie
    inside the L."""
    geo = gmsh.model.geo
    outer_y, outer_z = (
        geometry.inner_corner_y + geometry.thickness,
        geometry.inner_corner_z + geometry.thickness,
    )
    cells = section_cells(geometry, depths)
    corners = sorted(
        {(i + di, j + dj) for i, j in cells for di, dj in itertools.product((0, 1), repeat=2)}
    )
    point = {
        (i, j): geo.addPoint(geometry.x_start, outer_y - depths[i], outer_z - depths[j])
        for i, j in corners
    }
    line = {}
    for i, j in corners:
        for following, interval in (((i + 1, j), i), ((i, j + 1), j)):
            if following in point:
                line[(i, j), following] = tag = geo.addLine(point[i, j], point[following])
                count = divisions(depths[interval + 1] - depths[interval], element_size)
                geo.mesh.setTransfiniteCurve(tag, count + 1)
    section = []
    for i, j in cells:
        loop = geo.addCurveLoop(
            [
                line[(i, j), (i + 1, j)],
                line[(i + 1, j), (i + 1, j + 1)],
                -line[(i, j + 1), (i + 1, j + 1)],
                -line[(i, j), (i, j + 1)],
            ]
        )
        section.append(geo.addPlaneSurface([loop]))
        geo.mesh.setTransfiniteSurface(section[-1])
        geo.mesh.setRecombine(2, section[-1])
    return section


def _name_surfaces(gmsh, geometry: LRailGeometry) -> None:
    """Physical groups of the (+,+) rail, found as the surfaces that fill a flat box."""
    g = geometry
    outer_y, outer_z = g.inner_corner_y + g.thickness, g.inner_corner_z + g.thickness
    boxes = {
        "contact_y": [
            (
                (g.x_start, g.inner_corner_y, outer_z - g.leg),
                (g.x_end, g.inner_corner_y, g.inner_corner_z),
            )
        ],
        "contact_z": [
            (
                (g.x_start, outer_y - g.leg, g.inner_corner_z),
                (g.x_end, g.inner_corner_y, g.inner_corner_z),
            )
        ],
        "mount": [
            box
            for start, end in g.mount_spans
            for box in (
                (
                    (g.x_start + start, outer_y, outer_z - g.mount_width),
                    (g.x_start + end, outer_y, outer_z),
                ),
                (
                    (g.x_start + start, outer_y - g.mount_width, outer_z),
                    (g.x_start + end, outer_y, outer_z),
                ),
            )
        ],
    }
    for tag, name in enumerate(SURFACES, start=1):
        entities = [
            surface
            for low, high in boxes[name]
            for _, surface in gmsh.model.getEntitiesInBoundingBox(
                *(value - _TOUCH for value in low), *(value + _TOUCH for value in high), dim=2
            )
        ]
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
    surfaces = {
        name: elements(2, gmsh.model.getEntitiesForPhysicalGroup(2, tag), 4)
        for tag, name in enumerate(SURFACES, start=1)
    }
    return coordinates.reshape(-1, 3), hexes, surfaces
