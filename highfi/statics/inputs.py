"""All that the compliance of the rails under the pads reads from a scene, as one record. The statics
receives nothing else, and its result is stored under the digest of the record."""

from typing import NamedTuple

import numpy as np

from tipoff.files import content_hash
from tipoff.highfi.rail.scene_mesh import geometry
from tipoff.mechanics import model as scene_model
from tipoff.mechanics.model import Faces
from tipoff.meshes.l_rail import LRailGeometry
from tipoff.scenes.effects.mount_stiffness import MountStiffness
from tipoff.scenes.rail import MaterialTable
from tipoff.scenes.scene import Scene

_DIGITS = 12  # of a place in m: the frame of the platform changes the last bit of a wall's place
# of a table of a rail from a file, what its mesh does not depend on
_NOT_SHAPE = {"damping", "mount_stiffness", "material"}


class Inputs(NamedTuple):
    """``shape`` (JSON): what the mesh of the rails depends on beside the size of its elements;
    ``material`` without what statics and modes do not read; ``joint`` of the mounts, None where they
    are rigid; ``faces`` in scene axes; ``reach``, X (m) of both ends of the walls."""

    shape: dict
    material: MaterialTable
    joint: MountStiffness | None
    faces: Faces
    reach: tuple[float, float]

    def digest(self) -> str:
        """Hexadecimal digest of all of it."""
        faces = {name: array.tolist() for name, array in self.faces._asdict().items()}
        material = self.material.model_dump(mode="json")
        return content_hash(self.shape, material, self.joint, faces, self.reach)


def of(scene: Scene) -> Inputs:
    """The record of ``scene``. Raises SceneError where pads do not fit the built-in section or
    nothing holds it."""
    nominal = scene_model.built(scene).nominal
    wall = np.round(scene_model.in_scene_axes(scene, nominal).wall, _DIGITS)
    # the thermal offset is that of a unit of each field
    material = scene.rail.material.model_copy(update={"yield_strength": None, "expansion": None})
    return Inputs(
        _shape(scene),
        material,
        scene.rail.joint(),
        nominal._replace(wall=wall),
        (scene.rail.start, scene.rail.end),
    )


def _shape(scene: Scene) -> dict:
    if isinstance(section := geometry(scene), LRailGeometry):
        return section._asdict()
    # the content of the file counts, not its path
    return scene.rail.model_dump(mode="json", exclude=_NOT_SHAPE) | scene.rail.contents()
