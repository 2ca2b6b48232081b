"""Checks that the walls of a rail file are those of its scene, and that each solid is held.

The reference uses the file, the surrogate only the scene. So the walls of a file must end where the
scene says, lie under every pad face, and have the clearance of the scene from it, to a micrometre.
"""

import numpy as np

from tipoff.highfi.contact import surface
from tipoff.highfi.mesh import facets, pieces
from tipoff.highfi.mesh.rail_mesh import MeshError, RailMesh
from tipoff.mechanics import model as scene_model
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.rail import GeometryTable, MeshTable, SectionTable
from tipoff.scenes.scene import Scene

_SAME = 1e-6  # m: below what a rail is made to, above the rounding of any mesh format
_LIKE = 1e-3  # relative: a length that is the rail's in another unit, or along another axis
_AREA = 0.05  # relative: more than facets of a curved face lose, less than a box cuts off
_UNITS = {"millimetres": 1e3, "centimetres": 1e2, "inches": 1.0 / 0.0254}  # of them in a metre


def check_frame(scene: Scene, rail: MeshTable | GeometryTable, mesh: RailMesh) -> None:
    """Raise SceneError where the walls of a file have the length of the scene's in another unit or
    along another axis."""
    lengths = np.ptp(_corners(mesh).reshape(-1, 3), axis=0)
    longest = int(lengths.argmax())
    unit, along_x = _unit(rail, lengths)
    key, faults = f"rail.{rail.GIVEN_BY}", []
    if unit:
        given = f"walls {lengths[longest]:.6g} m long in {rail.path().name}"
        wanted = f"{rail.end - rail.start:.6g} m; the file seems to be in {unit}, not in metres"
        faults.append(Fault(scene.name, key, given, wanted))
    if not along_x:
        given = f"walls along {'xyz'[longest]} in {rail.path().name}"
        faults.append(Fault(scene.name, key, given, "scene axes, x along the rail to its open end"))
    if faults:
        raise SceneError(faults)


def unit_of(rail: MeshTable | GeometryTable, extent: np.ndarray) -> str:
    """What a file whose solid has this ``extent`` (2,3) m seems to have for metres and for X, as the
    end of a message; nothing where both are right."""
    unit, along_x = _unit(rail, np.ptp(extent, axis=0))
    words = [f"the file seems to be in {unit}, not in metres"] if unit else []
    if not along_x:
        words.append("its longest axis is not x, along which the scene has the rail")
    return "".join(f"; {each}" for each in words)


def _unit(rail: MeshTable | GeometryTable, lengths: np.ndarray) -> tuple[str, bool]:
    """The unit in which the longest of three ``lengths`` is that of the rail, nothing for metres or
    for none, and whether it lies along X where it is that of the rail at all."""
    longest = int(lengths.argmax())
    ratio = lengths[longest] / (rail.end - rail.start)
    units = [name for name, count in _UNITS.items() if abs(ratio / count - 1.0) < _LIKE]
    is_known = bool(units) or abs(ratio - 1.0) < _LIKE
    return units[0] if units else "", longest == 0 or not is_known


def check_areas(rail: GeometryTable, mesh: RailMesh) -> None:
    """Raise MeshError with every surface of a meshed solid whose area is not that of the solid's
    faces in its boxes."""
    faults = []
    for name, drawn in (mesh.drawn or {}).items():
        found = facets.area(mesh.points, mesh.surfaces[name])
        if abs(found - drawn) > _AREA * drawn:
            faults.append(
                f"surface '{name}': {1e6 * found:,.6g} mm2 of facets in its boxes, where the solid "
                f"has {1e6 * drawn:,.6g} mm2"
            )
    if faults:
        raise MeshError(
            f"{rail.path()} cannot be used:\n  "
            + "\n  ".join(faults)
            + "\n  a box ends within an element, or elements are too large for a curved face"
        )


def check_held(rail: MeshTable | GeometryTable, mesh: RailMesh) -> None:
    """Raise MeshError with the solids of a file that no facet of ``mount`` holds."""
    held = np.zeros(len(mesh.points), dtype=bool)
    held[mesh.surfaces["mount"]] = True
    loose = [mesh.points[own] for own in pieces.nodes(mesh) if not held[own].any()]
    if loose:
        raise MeshError(
            f"{rail.path()} cannot be used:\n  "
            + "\n  ".join(
                f"a solid without a facet of 'mount', {_reach(points)}: it would be loose, or it "
                "shares no nodes with the solid that it touches"
                for points in loose
            )
        )


def _reach(points: np.ndarray) -> str:
    spans = zip("xyz", points.min(axis=0), points.max(axis=0))
    return ", ".join(f"{axis} {low:.6g} to {high:.6g} m" for axis, low, high in spans)


def _corners(mesh: RailMesh) -> np.ndarray:
    """Nodes (m,k,3) m of all facets of the walls."""
    return mesh.points[
        np.concatenate(
            [group for name, group in mesh.surfaces.items() if name.startswith("contact")]
        )
    ]


def check_fit(scene: Scene, mesh: RailMesh) -> None:
    """Raise SceneError with every difference between the walls of a mesh or CAD file and those of the
    scene."""
    if isinstance(scene.rail, SectionTable) or scene.contact is None:
        return
    corners = _corners(mesh)
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
