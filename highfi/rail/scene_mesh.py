"""Mesh of a scene's rails: of the built-in L section, from a mesh file, or from a solid in a CAD
file."""

from dataclasses import replace
from functools import partial

import meshio
import numpy as np

from tipoff.files import content_hash
from tipoff.highfi.mesh import split
from tipoff.highfi.mesh.rail_mesh import MeshError, RailMesh, along_x, boundary_facets, read
from tipoff.highfi.rail import memory_fault, step_cost
from tipoff.highfi.rail.fit import check_areas, check_frame, check_held, unit_of
from tipoff.meshes import imprint, l_rail, msh, solid
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.rail import GeometryTable, SectionTable
from tipoff.scenes.scene import Scene


def geometry(scene: Scene) -> l_rail.LRailGeometry | str:
    """What the mesh of a scene depends on: dimensions of the L section, or the digest of the table
    and of its file.

    Raises SceneError where pads do not fit the built-in section or nothing holds it.
    """
    if isinstance(scene.rail, SectionTable):
        return _l_section(scene, scene.rail)
    return content_hash(
        scene.rail.model_dump(mode="json", exclude={"damping", "mount_stiffness"})
        | scene.rail.contents()
    )


def make_mesh(scene: Scene, element_size: float) -> RailMesh:
    """Rails of ``scene`` in scene axes, their elements about ``element_size`` (m). Raises
    SceneError, MeshError or, for a solid, GmshUnavailable."""
    if isinstance(scene.rail, SectionTable):
        return read(l_rail.build(_l_section(scene, scene.rail), element_size))
    if not scene.rail.is_as_found():
        raise MeshError(f"{scene.rail.path()} has changed since the scene was read")
    if isinstance(scene.rail, GeometryTable):
        meshed, areas = _meshed(scene, scene.rail, element_size)
        mesh = replace(read(meshed), drawn=areas)
        check_areas(scene.rail, mesh)
        check_held(scene.rail, mesh)
        mesh = along_x(mesh)
        mesh = step_cost.with_sliver_steps(mesh, scene.rail.material)
        return step_cost.with_run_time(mesh, scene, element_size)
    mesh = read(scene.rail.path())
    check_frame(scene, scene.rail, mesh)  # a mesh in millimetres would fill the memory
    check_held(scene.rail, mesh)
    # before the split, because its messages give the element numbers of the file
    mesh = step_cost.with_sliver_steps(mesh, scene.rail.material)
    memory_fault.require_split(scene, element_size, mesh)
    mesh = along_x(split.to_size(mesh, element_size))
    return step_cost.with_run_time(mesh, scene, min(element_size, step_cost.spacing(mesh)))


def _meshed(
    scene: Scene, rail: GeometryTable, element_size: float
) -> tuple[meshio.Mesh, dict[str, float]]:
    """The solid of a CAD file as elements, the facets of its boundary named after the boxes they
    lie in, and the area (m2) of the solid's own faces there."""
    boxes = {
        name: np.array([(box.low, box.high) for box in given])
        for name, given in rail.surfaces.items()
    }
    cost = partial(step_cost.ratio, rail.material, element_size)
    nodes = 10 if rail.elements == "tet10" else 8
    fits = partial(memory_fault.require_filled, scene, element_size, nodes)
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
    nodes = points[facets][:, None]
    inside = {
        name: ((nodes > box[:, 0, None] - imprint.SAME) & (nodes < box[:, 1, None] + imprint.SAME))
        .all(axis=(2, 3))
        .any(axis=1)
        for name, box in boxes.items()
    }
    return msh.tagged(points, cells, {name: facets[found] for name, found in inside.items()}), areas


def _l_section(scene: Scene, rail: SectionTable) -> l_rail.LRailGeometry:
    """Inner corners one clearance off the pads. Raises SceneError where pads do not fit it or
    nothing holds it."""
    places = {(abs(pad.position[1]), abs(pad.position[2])) for pad in scene.pads}
    faults = []
    if len(places) != 1:
        faults.append(
            Fault(
                scene.name,
                "pads",
                f"{len(places)} different distances from the axis",
                "pads at four corners (+-y, +-z) of one size, as the built-in L rails need",
            )
        )
    if not rail.mounts:
        faults.append(
            Fault(
                scene.name,
                "rail.mounts",
                "none",
                "at least one, since nothing else holds a rail that gives way",
            )
        )
    if faults:
        raise SceneError(faults)
    y, z = places.pop()
    clearance = scene.contact.clearance if scene.contact else 0.0
    return l_rail.LRailGeometry(
        rail.leg,
        rail.thickness,
        rail.start,
        rail.end,
        y + clearance,
        z + clearance,
        tuple((span.start, span.end) for span in rail.mounts),
        rail.mount_width,
    )
