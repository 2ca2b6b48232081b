"""Geometry of the rails of a scene, from which their mesh is made."""

from collections.abc import Collection

from tipoff.faults import Fault, SceneError
from tipoff.files import content_hash
from tipoff.highfi.rail import profile_rail
from tipoff.meshes import l_rail, profile
from tipoff.meshes.profile import Profile
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.rounding import apart, at_most
from tipoff.scenes.scene import Scene


def geometry(scene: Scene) -> l_rail.LRailGeometry | Profile | str:
    """Key of the mesh of a scene: dimensions of a section, or the digest of the table and of its
    file.

    Raises SceneError if pads do not fit the section or nothing holds it.
    """
    if isinstance(scene.rail, SectionTable):
        return l_section(scene, scene.rail)
    if isinstance(scene.rail, ProfileTable):
        return profile_rail.profile(scene, scene.rail)
    return content_hash(
        scene.rail.model_dump(mode="json", exclude={"damping", "mount_stiffness"})
        | scene.rail.contents()
    )


def require_walls(scene: Scene, conditions: Collection[str] = ()) -> None:
    """Raise SceneError with every fault of pads that do not lie beside the walls of their rail as the
    tables state them, in a scene and in some of its ``conditions``. Such a scene is wrong in every
    model. Walls in the file of a mesh or of a solid are checked when the file is read
    (``highfi.rail.fit``)."""
    faults = _beside_no_wall(scene)
    for name in conditions:
        own = [fault for fault in _beside_no_wall(scene.condition(name)) if fault not in faults]
        faults += [fault._replace(source=f"{fault.source}, {name}") for fault in own]
    if faults:
        raise SceneError(faults)


def _beside_no_wall(scene: Scene) -> list[Fault]:
    if isinstance(scene.rail, ProfileTable):
        return profile_rail.facing(scene, scene.rail)[1]
    return _on_fillet(scene, scene.rail) if isinstance(scene.rail, SectionTable) else []


def elements(scene: Scene, element_size: float) -> int | None:
    """Number of elements of the rails, about for a section of their own; None for rails from a file."""
    found = geometry(scene)
    if isinstance(found, l_rail.LRailGeometry):
        return l_rail.elements(found, element_size)
    return profile.elements(found, element_size) if isinstance(found, Profile) else None


def l_section(scene: Scene, rail: SectionTable) -> l_rail.LRailGeometry:
    """Inner corners one clearance off the pads. Raises SceneError if pads do not fit the section or
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
    faults += [*rail.unheld(scene.name), *_on_fillet(scene, rail)]
    if faults:
        raise SceneError(faults)
    y, z = places.pop()
    clearance = scene.contact.clearance if scene.contact else 0.0
    return l_rail.LRailGeometry(
        leg=rail.leg,
        thickness=rail.thickness,
        x_start=rail.start,
        x_end=rail.end,
        inner_corner_y=y + clearance,
        inner_corner_z=z + clearance,
        mount_spans=tuple(sorted((span.start, span.end) for span in rail.mounts)),
        mount_width=rail.mount_width,
        fillet=rail.fillet or 0.0,
    )


def _on_fillet(scene: Scene, rail: SectionTable) -> list[Fault]:
    """The fault of pads that reach the fillet. A pad whose corner touches both walls begins at
    ``inset - width / 2`` from the sharp corner, in the middle of the clearance farther from it."""
    begin = min(pad.inset - 0.5 * pad.width for pad in scene.pads)
    if rail.fillet is None or at_most(rail.fillet, begin, max(pad.inset for pad in scene.pads)):
        return []
    radius, free = apart(rail.fillet, begin)
    return [
        Fault(
            scene.name,
            "rail.fillet",
            f"{radius} m, with pads from {free} m on (inset less half of the width)",
            "pads beside the fillet: a smaller fillet, or a larger inset of the pads",
        )
    ]
