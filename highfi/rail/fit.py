"""Checks that the walls of a rail file agree with its scene, and that each solid is mounted.

The reference and the surrogates use the walls of a file as drawn: draft, bow, ramps and joints are
an offset of the wall along the rail (``highfi.rail.drawn_walls``). So the walls of a file must have
the ends of the scene, lie under the whole track of every pad face, and have the clearance of the
scene somewhere along it, within a micrometre. Every facet under the track is checked. None may be
steeper than ``STEEPEST`` or wave across the face, and facets may not meet at a step. A step is an
edge, which pads strike or fall off, and the contact potential jumps there.
"""

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.highfi.mesh import facets, pieces
from tipoff.highfi.mesh.asked import axes_along
from tipoff.highfi.mesh.rail_mesh import MeshError, RailMesh
from tipoff.highfi.rail import drawn_walls
from tipoff.highfi.rail.drawn_walls import SAME
from tipoff.mechanics.model import Faces
from tipoff.scenes import scene_model
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.rail import GeometryTable, MeshTable, SectionTable
from tipoff.scenes.rounding import apart
from tipoff.scenes.scene import Scene
from tipoff.units import LENGTHS_OF_FILES

# Degrees. Both solvers measure penetration along an axis of the scene, not along the normal of the
# wall. This makes pads stiffer by the square of half the slope: 0.2 % here.
STEEPEST = 5.0
_WAVE = 0.02  # of the clearance: largest deviation of a wall from a parabola across a face
_GAP = 0.1  # of the length of a face: longest piece of its track without wall
_LIKE = 1e-3  # relative, for a length equal to the rail's in another unit or along another axis
_AREA = 0.05  # relative: plane facets lose less of a curved face, a wrong box cuts off more
_UNITS = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "in": "inches", "ft": "feet"}


def check_frame(scene: Scene, rail: MeshTable | GeometryTable, mesh: RailMesh) -> None:
    """Raise SceneError if the walls of a file have the scene's length in another unit or along
    another axis."""
    lengths = np.ptp(drawn_walls.corners(mesh).reshape(-1, 3), axis=0)
    longest = int(lengths.argmax())
    unit, along_x = _unit(rail, lengths)
    key, faults = f"rail.{rail.GIVEN_BY}", []
    if unit:
        given = f"walls {lengths[longest]:.6g} m long in {rail.path().name}"
        own = getattr(rail, "unit", None) or "m"
        wanted = (
            f"{rail.end - rail.start:.6g} m; the file seems to be in {_UNITS[unit]}, not in "
            f'{_UNITS[own]}: if so, set rail.unit = "{unit}"'
        )
        faults.append(Fault(scene.name, key, given, wanted))
    if not along_x:
        given = f"walls along {'xyz'[longest]} in {rail.path().name}"
        wanted = "scene axes, x along the rail to its open end"
        if isinstance(rail, MeshTable):
            wanted += f"; rail.axes says which axes of the file they are, such as {axes_along(rail, longest)}"
        faults.append(Fault(scene.name, key, given, wanted))
    if faults:
        raise SceneError(faults)


def unit_of(rail: MeshTable | GeometryTable, extent: np.ndarray) -> str:
    """Guess of a wrong unit or axis of a file whose solid has this ``extent`` (2,3) m, as the end
    of a message; empty if both are right."""
    unit, along_x = _unit(rail, np.ptp(extent, axis=0))
    words = [f"the file seems to be in {_UNITS[unit]}, not in metres"] if unit else []
    if not along_x:
        words.append("its longest axis is not x, along which the scene has the rail")
    return "".join(f"; {each}" for each in words)


def _unit(rail: MeshTable | GeometryTable, lengths: np.ndarray) -> tuple[str, bool]:
    """The other unit of a file in which the longest of three ``lengths`` would be that of the rail
    (empty for none), and whether the length that equals the rail's is along X."""
    longest = int(lengths.argmax())
    ratio = lengths[longest] / (rail.end - rail.start)
    own = LENGTHS_OF_FILES[getattr(rail, "unit", None) or "m"]
    units = [
        name
        for name, scale in LENGTHS_OF_FILES.items()
        if scale != own and abs(ratio * scale / own - 1.0) < _LIKE
    ]
    is_known = bool(units) or abs(ratio - 1.0) < _LIKE
    return units[0] if units else "", longest == 0 or not is_known


def check_areas(rail: GeometryTable, mesh: RailMesh) -> None:
    """Raise MeshError with every surface of a meshed solid whose area differs from that of the
    solid's faces in its boxes."""
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
    """Raise MeshError with the solids of a file that have no facet of ``mount``."""
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


def check_fit(scene: Scene, mesh: RailMesh) -> None:
    """Raise SceneError with every difference between the walls of a mesh or CAD file and the
    scene."""
    if isinstance(scene.rail, (SectionTable, ProfileTable)) or scene.contact is None:
        return
    corners = drawn_walls.corners(mesh)
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
        if abs(stated - found) > SAME
    ]


def _wall_faults(
    scene: Scene, rail: MeshTable | GeometryTable, clearance: float, corners: np.ndarray
) -> list[tuple[str, str, str]]:
    """Pad faces without a wall, walls that an offset cannot describe, and walls with another
    clearance than the scene."""
    faces = scene_model.in_scene_axes(scene, scene_model.built(scene).nominal)
    drawn, file = rail.gap(clearance), rail.path().name
    # wrong ends are separate faults
    ends = max(rail.start, corners[..., 0].min()), min(rail.end, corners[..., 0].max())
    faults: list[tuple[str, str, str]] = []
    spans: list[tuple[float, ...]] = []
    for face in range(faces.axis.size):
        axis, sign, pad = faces.axis[face], faces.sign[face], faces.pad[face]
        name = f"{'+' if sign > 0.0 else '-'}{'xyz'[axis]}"
        near = drawn_walls.under(corners, faces, face, ends)
        if not len(near):
            wall = scene.pads[pad].position[axis] + sign * drawn
            faults.append(
                (
                    f"pads.{pad}",
                    f"a face {name} with no wall under its track",
                    f"a pad whose wall, at {name[1]} = {wall:.9g} m, is among the contact surfaces "
                    f"of {file}",
                )
            )
            continue
        faults += _hole_faults(near, faces, face, name, ends)
        away = drawn_walls.away(near, faces, face)
        if np.abs(away).max() <= SAME:
            spans.append((drawn, drawn, drawn))
            continue
        found = drawn_walls.track(near, faces, face, faces.half_width[face], ends)
        spans.append(
            tuple(drawn + float(each) for each in (away.min(), away.max(), found.gap.mean()))
        )
        faults += _shape_faults(near, found, faces, face, name, max(SAME, _WAVE * drawn))
    return list(dict.fromkeys(faults)) + _clearance_faults(rail, drawn, spans)


def _hole_faults(
    near: np.ndarray, faces: Faces, face: int, name: str, ends: tuple[float, float]
) -> list[tuple[str, str, str]]:
    """Pieces of the track of a face without any wall."""
    low, high = near[:, :, 0].min(axis=1), near[:, :, 0].max(axis=1)
    order = np.argsort(low)
    reached = np.maximum.accumulate(np.r_[ends[0], high[order]])
    starts, longest = np.r_[low[order], ends[1]], 2.0 * _GAP * faces.half_length[face]
    return [
        (
            f"pads.{faces.pad[face]}",
            f"a face {name} with no wall from x = {before:.6g} m to {after:.6g} m",
            f"a wall along its whole track, with gaps of at most {longest:.3g} m, a tenth of its "
            "length",
        )
        for before, after in zip(reached, starts)
        if after - before > longest
    ]


def _shape_faults(
    near: np.ndarray,
    found: drawn_walls.Track,
    faces: Faces,
    face: int,
    name: str,
    most: float,
) -> list[tuple[str, str, str]]:
    """The highest step and the steepest place of a wall, and the places that deviate from a
    parabola across a face by more than ``most`` (m)."""
    faults, key = [], f"pads.{faces.pad[face]}"
    height, x = drawn_walls.step(near, faces, face)
    if height > SAME:
        given, most_step = apart(1e6 * height, 1e6 * SAME, 3)
        ramp = 1e3 * height / np.tan(np.radians(STEEPEST))
        faults.append(
            (
                key,
                f"a face {name} whose wall has a step of {given} um at x = {x:.6g} m",
                f"at most {most_step} um: contact at an edge is not modelled; draw a ramp of at most "
                f"{STEEPEST:g} deg, here {ramp:.3g} mm or more along the rail",
            )
        )
    cosines = -faces.sign[face] * facets.normals(near)[:, faces.axis[face]]
    slopes = np.degrees(np.arccos(cosines.clip(-1.0, 1.0)))
    if slopes.max() > STEEPEST:
        place = near[int(slopes.argmax())].mean(axis=0)
        given, steepest = apart(float(slopes.max()), STEEPEST, 3)
        faults.append(
            (
                key,
                f"a face {name} whose wall has a slope of {given} deg at x = {place[0]:.6g} m",
                f"at most {steepest} deg: contact acts along {name[1]}",
            )
        )
    if found.missed.max() > most:
        where = found.place[int(found.missed.argmax())]
        given, largest = apart(1e6 * float(found.missed.max()), 1e6 * most, 3)
        faults.append(
            (
                key,
                f"a face {name} whose wall deviates by {given} um from a "
                f"parabola across the face at x = {where:.6g} m",
                f"at most {largest} um, 2 % of the clearance",
            )
        )
    return faults


def _clearance_faults(
    rail: MeshTable | GeometryTable, drawn: float, spans: list
) -> list[tuple[str, str, str]]:
    """Walls that have the clearance of the scene nowhere; ``spans`` (f,3) m: least, largest and
    mean clearance of each. The mean is along the track, independent of the elements."""
    if not any(low > drawn + SAME or high < drawn - SAME for low, high, _ in spans):
        return []
    means = [round(each[2], 9) for each in spans]
    found = " to ".join(f"{gap:.6g}" for gap in sorted({min(means), max(means)}))
    given = "nothing, hence that of contact" if rail.clearance is None else f"{drawn:.9g} m"
    walls = f"{found} m, at which the walls of {rail.path().name} stand off the pads"
    return [("rail.clearance", given, walls)]
