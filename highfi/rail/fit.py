"""Check that the walls of a rail file are those of its scene.

The reference uses the file, the surrogate only the scene. So the walls of a file must end where the
scene says, lie under every pad face, and have the clearance of the scene from it, to a micrometre.
"""

import numpy as np

from tipoff.highfi.contact import surface
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.mechanics import model as scene_model
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.rail import GeometryTable, MeshTable, SectionTable
from tipoff.scenes.scene import Scene

_SAME = 1e-6  # m: below what a rail is made to, above the rounding of any mesh format


def check_fit(scene: Scene, mesh: RailMesh) -> None:
    """Raise SceneError with every difference between the walls of a mesh or CAD file and those of the
    scene."""
    if isinstance(scene.rail, SectionTable) or scene.contact is None:
        return
    facets = np.concatenate(
        [quads for name, quads in mesh.surfaces.items() if name.startswith("contact")]
    )
    corners = mesh.points[facets]
    rail, clearance = scene.rail, scene.contact.clearance
    faults = _end_faults(rail, corners) + _wall_faults(scene, rail, clearance, corners)
    if faults:
        raise SceneError([Fault(scene.name, *fault) for fault in faults])


def _end_faults(rail: MeshTable | GeometryTable, corners: np.ndarray) -> list[tuple[str, str, str]]:
    ends = {
        "rail.start": (rail.start, corners[..., 0].min()),
        "rail.end": (rail.end, corners[..., 0].max()),
    }
    return [
        (
            key,
            f"{stated:.9g} m",
            f"{found:.9g} m, where the contact surfaces of {rail.path().name} end",
        )
        for key, (stated, found) in ends.items()
        if abs(stated - found) > _SAME
    ]


def _wall_faults(
    scene: Scene, rail: MeshTable | GeometryTable, clearance: float, corners: np.ndarray
) -> list[tuple[str, str, str]]:
    """Pad faces without a wall, and walls with another clearance than the scene's."""
    model, drawn = scene_model.build(scene), rail.gap(clearance)
    faces, file = model.faces, rail.path().name
    seen = corners - np.array(model.platform.mass_centre if model.platform else (0.0, 0.0, 0.0))
    faults, gaps = [], []
    for face in range(faces.axis.size):
        axis, sign, pad = faces.axis[face], faces.sign[face], faces.pad[face]
        name = f"{'+' if sign > 0.0 else '-'}{'xyz'[axis]}"
        near = seen[surface.in_reach(seen, faces, face)]
        if len(near):
            gaps.append(drawn + sign * (np.median(near[..., axis]) - faces.wall[face]))
            continue
        wall = scene.pads[pad].position[axis] + sign * drawn
        faults.append(
            (
                f"pads.{pad}",
                f"a face {name} with no wall under its track",
                f"a pad whose wall, at {name[1]} = {wall:.9g} m, is among the contact surfaces of "
                f"{file}",
            )
        )
    if any(abs(gap - drawn) > _SAME for gap in gaps):
        found = " to ".join(f"{gap:.9g}" for gap in sorted({min(gaps), max(gaps)}))
        faults.append(
            (
                "rail.clearance",
                "nothing, hence that of contact" if rail.clearance is None else f"{drawn:.9g} m",
                f"{found} m, at which the walls of {file} stand off the pads",
            )
        )
    return faults
