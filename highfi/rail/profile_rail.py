"""The rail of a scene that has a section of its own, as it is meshed: its walls are the sides that face
the pads."""

from tipoff.faults import Fault, SceneError
from tipoff.formats.outline import SAME
from tipoff.meshes.profile import Profile
from tipoff.scenes import scene_model
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.scene import Scene

_FACING = 1e-6  # of a unit normal: sides that are turned less face along an axis


def profile(scene: Scene, rail: ProfileTable) -> Profile:
    """The rail as meshed. Raises SceneError if nothing holds it, or a pad has no wall."""
    outline = rail.outline().at(rail.at)
    mounted = {rail.outline().side_at(point) for point in rail.mounted}
    walls, missing = facing(scene, rail)
    if scene.contact is None:  # nothing presses, but a mesh needs a wall
        walls = {*range(len(outline.sides()))} - mounted
    if faults := rail.unheld(scene.name) + missing:
        raise SceneError(faults)
    return Profile(
        loops=outline.loops,
        blocks=rail.blocks(),
        area=outline.moments().area,
        walls=tuple(sorted(walls)),
        mounted=tuple(sorted(mounted)),
        ends=(rail.start, rail.end),
        spans=tuple(sorted((span.start, span.end) for span in rail.mounts)),
        stretch=rail.stretch,
        images=rail.signs(),
    )


def facing(scene: Scene, rail: ProfileTable) -> tuple[set[int], list[Fault]]:
    """Numbers of the sides that face the pads, and the faults of pads that face none. Both are empty
    without contact."""
    if scene.contact is None:
        return set(), []
    sides, images = rail.outline().at(rail.at).sides(), rail.signs()
    faces = scene_model.in_scene_axes(scene, scene_model.built(scene).nominal)
    walls: set[int] = set()
    faults: list[Fault] = []
    for face in range(faces.axis.size):
        axis, sign = int(faces.axis[face]), float(faces.sign[face])
        wall, middle = float(faces.wall[face]), float(faces.centre[face, 3 - axis])
        found, apart = set(), []
        for image in images:
            own = axis - 1
            for number, side in enumerate(sides):
                if abs(image[own] * side.normal[own] + sign) > _FACING:
                    continue
                ends = sorted(image[1 - own] * end[1 - own] for end in side)
                if not ends[0] < middle < ends[1]:
                    continue
                place = image[own] * side.start[own]
                apart.append(place)
                if abs(place - wall) < SAME:
                    found.add(number)
        walls |= found
        if not found:
            name = f"{'+' if sign > 0.0 else '-'}{'xyz'[axis]}"
            nearest = min(apart, key=lambda place: abs(place - wall), default=None)
            faults.append(
                Fault(
                    scene.name,
                    f"pads.{faces.pad[face]}",
                    f"a face {name} without a wall at {name[1]} = {wall:.9g} m",
                    "a side of the section that faces it there, one clearance off the pad; "
                    + (
                        "no side faces it"
                        if nearest is None
                        else f"the nearest one that faces it is at {nearest:.9g} m"
                    ),
                )
            )
    return walls, faults
