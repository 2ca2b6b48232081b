"""All inputs of the compliance of the rails under the pads, as one record. The statics uses nothing
else of a scene, and its result is stored under the digest of the record."""

from typing import NamedTuple

import numpy as np

from tipoff.files import content_hash
from tipoff.highfi.rail.geometry import geometry
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.mechanics.model import Faces
from tipoff.scenes import scene_model
from tipoff.scenes.rail_base import MaterialTable
from tipoff.scenes.scene import Scene

_DIGITS = 12  # decimals of a place in m: the last bit of a wall depends on the platform's frame
# keys of the table of a rail from a file that do not change its mesh
_NOT_SHAPE = {"damping", "mount_stiffness", "material"}


class Inputs(NamedTuple):
    """Inputs of statics and modes."""

    shape: dict  # JSON, defines the mesh of the rails, except for the element size
    material: MaterialTable  # without the keys that statics and modes do not use
    joint: MountStiffness | None  # of the mounts, None if they are rigid
    faces: Faces  # in scene axes
    reach: tuple[float, float]  # m, X of both ends of the walls

    def digest(self) -> str:
        """Hexadecimal digest of the record."""
        faces = {name: array.tolist() for name, array in self.faces._asdict().items()}
        material = self.material.model_dump(mode="json")
        return content_hash(self.shape, material, self.joint, faces, self.reach)


def nominal(scene: Scene) -> Scene:
    """``scene`` with a factor of 1 on the stiffness of its mounts."""
    if scene.rail.mount_stiffness is None:
        return scene
    return scene.replace({"rail.mount_stiffness.factor": 1.0})


def of_scene(scene: Scene) -> Inputs:
    """The record of ``scene``. Raises SceneError if pads do not fit the built-in section or nothing
    holds it."""
    faces = scene_model.built(scene).nominal
    wall = np.round(scene_model.in_scene_axes(scene, faces).wall, _DIGITS)
    # the thermal offset is for a unit of each field
    material = scene.rail.material.model_copy(update={"yield_strength": None, "expansion": None})
    return Inputs(
        _shape(scene),
        material,
        scene.rail.joint(),
        faces._replace(wall=wall),
        (scene.rail.start, scene.rail.end),
    )


def _shape(scene: Scene) -> dict:
    if not isinstance(section := geometry(scene), str):
        shape = section._asdict()
        if shape.get("fillet") == 0.0:  # results of sharp sections are stored without this key
            del shape["fillet"]
        return shape
    # the content of the file identifies it, not its path
    return scene.rail.model_dump(mode="json", exclude=_NOT_SHAPE) | scene.rail.contents()
