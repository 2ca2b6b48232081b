"""Mesh of a scene's rails: of the built-in L section, from a mesh file, or from a solid in a CAD
file."""

from dataclasses import replace

import meshio
import numpy as np

from tipoff.files import content_hash
from tipoff.highfi.dynamics import stable_step
from tipoff.highfi.mesh import split
from tipoff.highfi.mesh.rail_mesh import (
    MeshError,
    RailMesh,
    along_x,
    boundary_facets,
    listed,
    read,
    slivers,
)
from tipoff.highfi.rail.fit import check_frame, check_held
from tipoff.highfi.statics import assembly
from tipoff.meshes import l_rail, msh, solid
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.rail import GeometryTable, SectionTable
from tipoff.scenes.scene import Scene

_SAME = 1e-6  # m, how far a node of a facet may lie outside the box that names it


def geometry(scene: Scene) -> l_rail.LRailGeometry | str:
    """What the mesh of a scene depends on: dimensions of the L section, or the digest of the table
    and of its file.

    Raises SceneError where pads do not fit the built-in section or nothing holds it.
    """
    if isinstance(scene.rail, SectionTable):
        return _l_section(scene, scene.rail)
    return content_hash(
        scene.rail.model_dump(mode="json", exclude={"damping"}) | scene.rail.contents()
    )


def make_mesh(scene: Scene, element_size: float) -> RailMesh:
    """Rails of ``scene`` in scene axes, their elements about ``element_size`` (m). Raises
    SceneError, MeshError or, for a solid, GmshUnavailable."""
    if isinstance(scene.rail, SectionTable):
        return read(l_rail.build(_l_section(scene, scene.rail), element_size))
    if not scene.rail.is_as_found():
        raise MeshError(f"{scene.rail.path()} has changed since the scene was read")
    if isinstance(scene.rail, GeometryTable):
        mesh = read(_meshed(scene.rail, element_size))
        check_held(scene.rail, mesh)
        return with_steps(along_x(mesh), scene.rail.material)
    mesh = read(scene.rail.path())
    check_frame(scene, scene.rail, mesh)  # a mesh in millimetres would fill the memory
    check_held(scene.rail, mesh)
    # before the split, because its messages give the element numbers of the file
    mesh = with_steps(mesh, scene.rail.material)
    return along_x(split.to_size(mesh, element_size))


def _meshed(rail: GeometryTable, element_size: float) -> meshio.Mesh:
    """The solid of a CAD file as elements, the facets of its boundary named after the boxes they
    lie in."""
    boxes = {
        name: np.array([(box.low, box.high) for box in given])
        for name, given in rail.surfaces.items()
    }
    try:
        planes = np.concatenate(list(boxes.values())).reshape(-1, 3)
        points, cells = solid.build(
            rail.path(), element_size, planes, tetrahedra=rail.elements == "tet10"
        )
    except ValueError as fault:
        raise MeshError(f"{rail.path()} cannot be used: {fault}") from fault
    facets = boundary_facets(cells)
    nodes = points[facets][:, None]
    inside = {
        name: ((nodes > box[:, 0, None] - _SAME) & (nodes < box[:, 1, None] + _SAME))
        .all(axis=(2, 3))
        .any(axis=1)
        for name, box in boxes.items()
    }
    if empty := [name for name, found in inside.items() if not found.any()]:
        spans = zip("xyz", points.min(axis=0), points.max(axis=0))
        reach = ", ".join(f"{axis} {low:.6g} to {high:.6g}" for axis, low, high in spans)
        raise MeshError(
            f"{rail.path()} cannot be used: no face of the solid ({reach} m) lies in the boxes of "
            f"{', '.join(empty)}"
        )
    return msh.tagged(points, cells, {name: facets[found] for name, found in inside.items()})


def with_steps(mesh: RailMesh, material) -> RailMesh:
    """``mesh``; where it has slivers, with a warning that gives the step (s) they require."""
    thin = slivers(mesh.points, mesh.cells)
    if not len(thin):
        return mesh

    def largest_step(cells):
        part = assembly.build(
            replace(mesh, cells=cells),
            material.density,
            material.youngs_modulus,
            material.poisson_ratio,
        )
        return stable_step.critical_step(stable_step.element_bound(part))

    forced, other = (
        largest_step(mesh.cells[thin]),
        largest_step(np.delete(mesh.cells, thin, axis=0)),
    )
    words = (
        f"slivers {listed(thin)} force a step of at most {forced:.3g} s, the other elements "
        f"one of {other:.3g} s"
    )
    return replace(mesh, warnings=(*mesh.warnings, words))


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
