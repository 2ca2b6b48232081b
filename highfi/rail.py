"""The mesh of a scene's rail: the built-in L section, or a file of the user's own that must agree with what the scene says of it.

A file has the last word in the reference, the scene in the surrogate. So that both speak of one rail, the walls of a file must end
where the scene says that they do, lie under every pad face, and stand one clearance off it, all to a micrometre.
"""

from dataclasses import replace

import numpy as np

from highfi import assembly, split, surface, timestep
from highfi.mesh import MeshError, RailMesh, along_x, listed, read, slivers
from meshes import l_rail
from scenes import model as scene_model
from scenes.faults import Fault, SceneError
from scenes.files import content_hash
from scenes.rail import SectionTable
from scenes.scene import Scene

_SAME = 1e-6  # m: below what a rail is made to, above the rounding of any mesh format


def geometry(scene: Scene) -> l_rail.LRailGeometry | str:
    """What the mesh of a scene depends on: dimensions of the L section, or the digest of the table and of its file.

    Raises SceneError where pads do not fit the built-in section.
    """
    if isinstance(scene.rail, SectionTable):
        return _l_section(scene)
    return content_hash(scene.rail.model_dump(mode="json") | scene.rail.contents())


def make_mesh(scene: Scene, element_size: float) -> RailMesh:
    """Rails of ``scene`` in scene axes, their elements about ``element_size`` (m). Raises SceneError or MeshError."""
    if isinstance(scene.rail, SectionTable):
        return read(l_rail.build(_l_section(scene), element_size))
    if not scene.rail.is_as_found():
        raise MeshError(f"{scene.rail.path()} has changed since the scene was read")
    mesh = with_steps(read(scene.rail.path()), scene.rail.material)  # first, since it speaks of the file's own element numbers
    return along_x(split.to_size(mesh, element_size))


def with_steps(mesh: RailMesh, material) -> RailMesh:
    """``mesh`` with a warning, where it has slivers, that says which step (s) they force on all other elements."""
    thin = slivers(mesh.points, mesh.hexes)
    if not len(thin):
        return mesh

    def largest_step(hexes):
        part = assembly.build(replace(mesh, hexes=hexes), material.density, material.youngs_modulus, material.poisson_ratio)
        return timestep.critical_step(timestep.element_bound(part))

    forced, other = largest_step(mesh.hexes[thin]), largest_step(np.delete(mesh.hexes, thin, axis=0))
    words = f"slivers {listed(thin)} force a step of at most {forced:.3g} s, the other elements one of {other:.3g} s"
    return replace(mesh, warnings=(*mesh.warnings, words))


def check_fit(scene: Scene, mesh: RailMesh) -> None:
    """Raise SceneError with every place where a mesh of the user's own and the scene speak of different walls."""
    if isinstance(scene.rail, SectionTable) or scene.contact is None:
        return
    facets = np.concatenate([quads for name, quads in mesh.surfaces.items() if name.startswith("contact")])
    corners = mesh.points[facets]
    faults = _end_faults(scene, corners) + _wall_faults(scene, corners)
    if faults:
        raise SceneError([Fault(scene.name, *fault) for fault in faults])


def _end_faults(scene: Scene, corners: np.ndarray) -> list[tuple[str, str, str]]:
    ends = {"rail.start": (scene.rail.start, corners[..., 0].min()), "rail.end": (scene.rail.end, corners[..., 0].max())}
    return [(key, f"{said:.9g} m", f"{found:.9g} m, where the contact surfaces of {scene.rail.path().name} end")
            for key, (said, found) in ends.items() if abs(said - found) > _SAME]


def _wall_faults(scene: Scene, corners: np.ndarray) -> list[tuple[str, str, str]]:
    """Pad faces over no wall, and walls that do not stand one clearance off them."""
    model, clearance = scene_model.build(scene), scene.contact.clearance
    faces, file = model.faces, scene.rail.path().name
    seen = corners - np.array(model.platform.mass_centre if model.platform else (0.0, 0.0, 0.0))
    faults, gaps = [], []
    for face in range(faces.axis.size):
        axis, sign, pad = faces.axis[face], faces.sign[face], faces.pad[face]
        name = f"{'+' if sign > 0.0 else '-'}{'xyz'[axis]}"
        near = seen[surface.in_reach(seen, faces, face)]
        if len(near):
            gaps.append(clearance + sign * (np.median(near[..., axis]) - faces.wall[face]))
            continue
        wall = scene.pads[pad].position[axis] + sign * clearance
        faults.append((f"pads.{pad}", f"a face {name} with no wall under its track",
                       f"a pad whose wall, at {name[1]} = {wall:.9g} m, is among the contact surfaces of {file}"))
    if any(abs(gap - clearance) > _SAME for gap in gaps):
        found = " to ".join(f"{gap:.9g}" for gap in sorted({min(gaps), max(gaps)}))
        faults.append(("contact.clearance", f"{clearance:.9g} m", f"{found} m, at which the walls of {file} stand off the pads"))
    return faults


def _l_section(scene: Scene) -> l_rail.LRailGeometry:
    """Inner corners one clearance off the pads. Raises SceneError where pads do not fit it."""
    places = {(abs(pad.position[1]), abs(pad.position[2])) for pad in scene.pads}
    if len(places) != 1:
        raise SceneError([Fault(scene.name, "pads", f"{len(places)} different distances from the axis",
                                "pads at four corners (+-y, +-z) of one size, as the built-in L rails need")])
    (y, z), rail = places.pop(), scene.rail
    clearance = scene.contact.clearance if scene.contact else 0.0
    return l_rail.LRailGeometry(rail.leg, rail.thickness, rail.start, rail.end, y + clearance, z + clearance,
                                tuple((span.start, span.end) for span in rail.mounts), rail.mount_width)
