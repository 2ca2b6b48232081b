"""Elements of a solid from a CAD file, with the facets of its boundary named after the boxes of its
scene."""

from functools import partial

import numpy as np

from tipoff.faults import SceneError
from tipoff.highfi.mesh.rail_mesh import MeshError, boundary_facets
from tipoff.highfi.rail import memory_fault, step_cost
from tipoff.highfi.rail.fit import unit_of
from tipoff.meshes import imprint, solid
from tipoff.scenes.rail import GeometryTable
from tipoff.scenes.scene import Scene


def meshed(
    scene: Scene, element_size: float, memory: int | None
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray], dict[str, float]]:
    """Points (n,3) m, elements (e,8) or (e,10), facets (m,4) or (m,6) of each surface, and the area
    (m2) of the solid's own faces in its boxes. ``memory``: limit for the mesh (bytes), None if it
    is unknown.

    Raises SceneError, MeshError or GmshUnavailable.
    """
    rail = scene.rail
    assert isinstance(rail, GeometryTable)
    boxes = {
        name: np.array([(box.low, box.high) for box in given])
        for name, given in rail.surfaces.items()
    }
    cost = partial(step_cost.ratio, rail.material, element_size)
    nodes = 10 if rail.elements == "tet10" else 8
    fits = partial(memory_fault.require_filled, scene, element_size, nodes, memory)
    filling = solid.Filling(rail.elements == "tet10", cost, step_cost.MOST, fits)
    try:
        points, cells, areas = solid.build(rail.path(), element_size, boxes, filling)
    except imprint.Outside as fault:
        raise MeshError(
            f"{rail.path()} cannot be used: {fault}{unit_of(rail, fault.extent)}"
        ) from fault
    except SceneError:
        raise
    except ValueError as fault:
        raise MeshError(f"{rail.path()} cannot be used: {fault}") from fault
    facets = boundary_facets(cells)
    corners = points[facets][:, None]
    inside = {
        name: (
            (corners > box[:, 0, None] - imprint.SAME) & (corners < box[:, 1, None] + imprint.SAME)
        )
        .all(axis=(2, 3))
        .any(axis=1)
        for name, box in boxes.items()
    }
    return points, cells, {name: facets[found] for name, found in inside.items()}, areas
