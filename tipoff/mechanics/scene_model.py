"""Constant records of a scene for the kernels of both solvers; None for an absent effect.

Places on the payload are measured from its *actual* mass centre in body axes; places on the rail
from the platform's mass centre at ignition (the scene origin when the platform is fixed), in
platform axes, which coincide with scene axes then.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from tipoff.kernels.reference import by_reference
from tipoff.scenes import stop
from tipoff.scenes.body import inverse, tensor
from tipoff.scenes.effects import contact, hold_down, registry, spring, thrust, thrust_offset
from tipoff.scenes.effects.body_force import BodyForce
from tipoff.scenes.effects.friction import Friction
from tipoff.scenes.effects.initial import Initial
from tipoff.scenes.effects.platform import Platform
from tipoff.scenes.effects.pusher_law import Pushers
from tipoff.scenes.effects.sticking import Sticking
from tipoff.scenes.effects.thermal import Thermal
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


@by_reference
class Payload(NamedTuple):
    """Mass properties of the payload."""

    mass: float  # kg
    inertia: np.ndarray  # (3,3) kg m2, about the mass centre
    inverse_inertia: np.ndarray  # (3,3) 1/(kg m2)
    mass_centre: tuple  # (3,) m, at rest, in scene axes


@by_reference
class Faces(NamedTuple):
    """f pad faces, and the rail walls that they may touch."""

    centre: np.ndarray  # (f,3) m, in body axes
    axis: np.ndarray  # (f,) 1 or 2, axis of the normal
    sign: np.ndarray  # (f,) of the normal
    half_length: np.ndarray  # (f,) m
    half_width: np.ndarray  # (f,) m
    relief: np.ndarray  # (f,) m
    wall: np.ndarray  # (f,) m, coordinate of the undeformed wall along axis, in platform axes
    pad: np.ndarray  # (f,) index of its pad


class Plate(NamedTuple):
    """Bounds of the walls across the rail. A rail from a file without thickness or leg has those of
    the built-in section."""

    thickness: float  # m, of the walls
    leg: float  # m, largest width of the walls
    across: np.ndarray  # (f,) m, position of each centred face across the rail, in platform axes


class Model(NamedTuple):
    """All records of one scene."""

    payload: Payload
    faces: Faces
    plate: Plate
    rail_start: float  # m, X in platform axes
    rail_end: float  # m, X in platform axes
    thrust: thrust.Thrust  # over time
    pushers: Pushers | None  # thrust over travel
    reacts_on_platform: bool
    thrust_offset: thrust_offset.ThrustOffset | None
    hold_down: hold_down.HoldDown | None  # latch or stop; None after the release too
    contact: contact.ContactLaw | None
    interface_stiffness: float | None  # N/m3, interface and pad layer in series
    friction: Friction | Sticking | None
    platform: Platform | None
    body_force: BodyForce | None  # on the payload; None on a free platform, which falls alike
    fall: BodyForce | None  # acceleration of the frame of the solution (``mechanics.comoving``)
    thermal: Thermal | None
    initial: Initial
    thrust_arm: float  # m


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
        hold_down=stop.record(scene),
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


def half_sizes(faces: Faces) -> np.ndarray:
    """Half size (f,2) m of ``nominal`` faces along xi and eta; negative if eta is opposite to the
    axis, as on mirrored pads."""
    across = faces.centre[np.arange(faces.axis.size), 3 - faces.axis]
    return np.column_stack(
        [faces.half_length, np.where(across >= 0.0, 1.0, -1.0) * faces.half_width]
    )


def _payload(scene: Scene) -> Payload:
    inertia = tensor(scene.payload.inertia)
    return Payload(scene.payload.mass, inertia, inverse(inertia), (0.0, 0.0, 0.0))


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
    rows = []
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
    )
