"""Constant records of a scene for the kernels of both solvers; None for an absent effect.

Places on the payload are measured from its *actual* mass centre in body axes; places on the rail
from the platform's mass centre at ignition (the scene origin when the platform is fixed), in
platform axes, which coincide with scene axes then.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.reference import by_reference
from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.mechanics.laws.contact import ContactLaw
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.initial import Initial
from tipoff.mechanics.laws.platform import Platform
from tipoff.mechanics.laws.pushers import Pushers
from tipoff.mechanics.laws.sticking import Sticking
from tipoff.mechanics.laws.thermal import Thermal
from tipoff.mechanics.laws.thrust import Thrust
from tipoff.mechanics.laws.thrust_offset import ThrustOffset


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
    guide: np.ndarray  # (f,) index of its guide: the pads of one button, or one pad


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
    thrust: Thrust  # over time
    pushers: Pushers | None  # thrust over travel
    reacts_on_platform: bool
    thrust_offset: ThrustOffset | None
    hold_down: HoldDown | None  # latch or stop; None after the release too
    contact: ContactLaw | None
    interface_stiffness: float | None  # N/m3, interface and pad layer in series
    friction: Friction | Sticking | None
    platform: Platform | None
    body_force: BodyForce | None  # on the payload; None on a free platform, which falls alike
    fall: BodyForce | None  # acceleration of the frame of the solution (``mechanics.comoving``)
    thermal: Thermal | None
    initial: Initial
    thrust_arm: float  # m


def half_sizes(faces: Faces) -> np.ndarray:
    """Half size (f,2) m of ``nominal`` faces along xi and eta; negative if eta is opposite to the
    axis, as on mirrored pads."""
    across = faces.centre[np.arange(faces.axis.size), 3 - faces.axis]
    return np.column_stack(
        [faces.half_length, np.where(across >= 0.0, 1.0, -1.0) * faces.half_width]
    )
