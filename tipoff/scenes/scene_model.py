"""The constant records of a scene (``mechanics.model``)."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from tipoff.mechanics.estimates import stop
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.initial import Initial
from tipoff.mechanics.laws.platform import Platform
from tipoff.mechanics.model import Faces, Model, Payload, Plate
from tipoff.scenes import guides, launch
from tipoff.scenes.body import inverse, tensor
from tipoff.scenes.effects import hold_down, registry, spring, thrust_offset
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.scene import Scene

# Tables of a scene whose records can be reused.
_REUSED = (
    "payload",
    "pads",
    "rail",
    "thrust",
    "initial",
    "contact",
    "friction",
    "platform",
    "thermal",
)
_OF_FACES = ("pads", "rail", "contact", "platform")


class Built(NamedTuple):
    """A model with its scene."""

    scene: Scene
    model: Model
    nominal: Faces  # relative to the nominal mass centre


def build(scene: Scene) -> Model:
    """Records of ``scene``."""
    return built(scene).model


def built(scene: Scene, earlier: Built | None = None) -> Built:
    """Records of ``scene``. Records of tables that are the same in an ``earlier`` scene are
    reused."""
    same = (
        {name for name in _REUSED if getattr(earlier.scene, name) is getattr(scene, name)}
        if earlier
        else set()
    )

    def kept(field: str, make: Callable[[], Any], *tables: str) -> Any:
        """The earlier record if its ``tables`` (default: the one of its name) are the same, else a
        new one."""
        if earlier and same.issuperset(tables or (field,)):
            return getattr(earlier.model, field)
        return make()

    offset = scene.mass_offset.eccentricity.offset() if scene.mass_offset else (0.0, 0.0, 0.0)
    platform = kept("platform", lambda: scene.platform.record() if scene.platform else None)
    origin = platform.mass_centre[0] if platform else 0.0
    nominal = earlier.nominal if earlier and same.issuperset(_OF_FACES) else _faces(scene, platform)
    model = Model(
        payload=kept("payload", lambda: _payload(scene))._replace(mass_centre=offset),
        faces=nominal._replace(centre=nominal.centre - np.array(offset)),
        plate=kept("plate", lambda: _plate(scene, nominal, platform), *_OF_FACES),
        rail_start=scene.rail.start - origin,
        rail_end=scene.rail.end - origin,
        thrust=kept("thrust", scene.thrust.record),
        pushers=spring.record(scene.thrust, scene.thrust_offset, scene.mass_offset, platform),
        reacts_on_platform=scene.thrust.reaction == "platform",
        thrust_offset=thrust_offset.record(
            scene.thrust_offset, scene.mass_offset, scene.thrust.arm
        ),
        hold_down=_hold_down(scene),
        contact=kept("contact", lambda: scene.contact.record() if scene.contact else None),
        interface_stiffness=scene.contact.series_stiffness() if scene.contact else None,
        # Friction without contact has no normal force, so it is absent too.
        friction=kept(
            "friction",
            lambda: scene.friction.record() if scene.friction and scene.contact else None,
            "friction",
            "contact",
        ),
        platform=platform,
        body_force=registry.body_force(scene) if platform is None else None,
        fall=registry.body_force(scene) if platform is not None else None,
        thermal=kept(
            "thermal",
            lambda: scene.thermal.record(scene.rail) if scene.thermal else None,
            "rail",
            "thermal",
        ),
        initial=kept("initial", lambda: scene.initial.record() if scene.initial else Initial()),
        thrust_arm=scene.thrust.arm,
    )
    return Built(scene, model, nominal)


def in_scene_axes(scene: Scene, nominal: Faces) -> Faces:
    """``nominal`` faces with the coordinates of their walls in scene axes."""
    origin = np.array(scene.platform.record().mass_centre if scene.platform else (0.0, 0.0, 0.0))
    return nominal._replace(wall=nominal.wall + origin[nominal.axis])


def _payload(scene: Scene) -> Payload:
    inertia = tensor(scene.payload.inertia)
    return Payload(scene.payload.mass, inertia, inverse(inertia), (0.0, 0.0, 0.0))


def _hold_down(scene: Scene) -> HoldDown | None:
    """Latch and stop, None if nothing is held after the ignition. Raises SceneError as
    ``hold_down.require``."""
    hold_down.require(scene)
    along = launch.of_scene(scene)
    time = stop.release_time(along)
    centre = scene.platform.mass_centre if scene.platform is not None else None
    line = (0.0, 0.0) if centre is None else (-centre.y, -centre.z)
    return HoldDown(time, line, time > along.latched) if time > 0.0 else None


def _plate(scene: Scene, nominal: Faces, platform: Platform | None) -> Plate:
    origin = np.array(platform.mass_centre if platform else (0.0, 0.0, 0.0))
    thickness, leg = (
        getattr(scene.rail, name) or SectionTable.model_fields[name].default
        for name in ("thickness", "leg")
    )
    return Plate(
        thickness, leg, (nominal.centre - origin)[np.arange(nominal.axis.size), 3 - nominal.axis]
    )


def _faces(scene: Scene, platform: Platform | None) -> Faces:
    """Faces with centres relative to the nominal mass centre."""
    origin = platform.mass_centre if platform else (0.0, 0.0, 0.0)
    gaps = scene.contact.gaps() if scene.contact else (0.0, 0.0, 0.0)
    gap = scene.rail.gap(gaps[0])
    rows, number = [], guides.numbers(scene.pads)
    for index, pad in enumerate(scene.pads):
        corner = np.array(pad.position)
        for normal in pad.normals:
            axis, sign = "xyz".index(normal[1]), 1.0 if normal[0] == "+" else -1.0
            across = 3 - axis
            centre = corner.copy()
            centre[across] -= np.sign(corner[across]) * pad.inset
            # a shim, if walls as drawn have another distance from the pads
            centre[axis] += sign * (gap - gaps[axis])
            wall = corner[axis] + sign * gap - origin[axis]
            rows.append(
                (centre, axis, sign, pad.length / 2, pad.width / 2, pad.relief, wall, index)
            )
    columns = list(zip(*rows))
    return Faces(
        centre=np.array(columns[0]),
        axis=np.array(columns[1], dtype=np.int64),
        sign=np.array(columns[2]),
        half_length=np.array(columns[3]),
        half_width=np.array(columns[4]),
        relief=np.array(columns[5]),
        wall=np.array(columns[6]),
        pad=np.array(columns[7], dtype=np.int64),
        guide=np.array([number[pad] for pad in columns[7]], dtype=np.int64),
    )
