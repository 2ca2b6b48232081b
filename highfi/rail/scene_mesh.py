"""Mesh of a scene's rails: of the built-in L section, of another section, from a mesh file, or from a
solid in a CAD file."""

from dataclasses import replace

import meshio

from tipoff.faults import SceneError
from tipoff.highfi.mesh import split, touching
from tipoff.highfi.mesh.asked import asked
from tipoff.highfi.mesh.rail_mesh import MeshError, RailMesh, along_x, read
from tipoff.highfi.rail import memory_fault, profile_rail, solid_process, step_cost
from tipoff.highfi.rail.fit import check_areas, check_frame, check_held
from tipoff.highfi.rail.geometry import l_section
from tipoff.meshes import l_rail, profile
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.rail import GeometryTable, SectionTable
from tipoff.scenes.scene import Scene


def make_mesh(scene: Scene, element_size: float) -> RailMesh:
    """Rails of ``scene`` in scene axes, their elements about ``element_size`` (m). Raises
    SceneError, MeshError or, for a solid, GmshUnavailable."""
    if isinstance(scene.rail, SectionTable):
        return read(l_rail.build(l_section(scene, scene.rail), element_size), made_here=True)
    if isinstance(scene.rail, ProfileTable):
        mesh = read(_profile(scene, scene.rail, element_size), made_here=True)
        return step_cost.with_run_time(mesh, scene, element_size)
    if not scene.rail.is_as_found():
        raise MeshError(f"{scene.rail.path()} has changed since the scene was read")
    if isinstance(scene.rail, GeometryTable):
        meshed, areas = solid_process.mesh_of(scene, scene.rail, element_size)
        mesh = replace(read(meshed, made_here=True), drawn=areas)
        check_areas(scene.rail, mesh)
        check_held(scene.rail, mesh)
        mesh = along_x(mesh)
        mesh = step_cost.with_sliver_steps(mesh, scene.rail.material)
        return step_cost.with_run_time(mesh, scene, element_size)
    mesh = read(scene.rail.path(), asked(scene.rail))
    check_frame(scene, scene.rail, mesh)  # a mesh in millimetres would fill the memory
    check_held(scene.rail, mesh)
    mesh = replace(mesh, warnings=(*mesh.warnings, *touching.warning(mesh)))
    # before the split, because its messages give the element numbers of the file
    mesh = step_cost.with_sliver_steps(mesh, scene.rail.material)
    memory_fault.require_split(scene, element_size, mesh)
    mesh = along_x(split.to_size(mesh, element_size))
    return step_cost.with_run_time(mesh, scene, min(element_size, step_cost.spacing(mesh)))


def _profile(scene: Scene, rail: ProfileTable, element_size: float) -> meshio.Mesh:
    try:
        return profile.build(profile_rail.profile(scene, rail), element_size)
    except SceneError:
        raise
    except ValueError as fault:
        raise MeshError(f"rail.section cannot be used: {fault}") from fault
