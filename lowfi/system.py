"""What the kernels of the surrogate are given: the scene's records, cut down to what a rigid run
reads.

Faces are one table, because every array in a record makes each kernel that passes the record on
longer to compile.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.mechanics.model import Model
from tipoff.scenes.effects.body_force import BodyForce
from tipoff.scenes.effects.contact import HuntCrossley, Impact, Linear
from tipoff.scenes.effects.friction import Friction
from tipoff.scenes.effects.sticking import Sticking
from tipoff.scenes.effects.thrust_law import Thrust
from tipoff.scenes.effects.thrust_offset import ThrustOffset

if TYPE_CHECKING:
    from tipoff.lowfi.contact.compliant.record import Compliance
    from tipoff.lowfi.contact.thermal_offset import Bow

# Columns of the table of faces: centre in payload body axes (m); outward normal's y and z and the
# wall's distance along it (m), in platform axes; half the length (m); its own number; and where the
# wall ends (``lowfi.contact.wall_ends``): how far (m) the middle of the face may be beyond an end of the rail,
# where it stands across the rail when centred (m, platform axes), how far from there it may be (m),
# the thickness of the wall (m), and how deep (m) its edge may come over that of the wall.
(
    CENTRE,
    NORMAL_Y,
    NORMAL_Z,
    WALL,
    HALF_LENGTH,
    NUMBER,
    OVERHANG,
    SIDE_MIDDLE,
    SIDE_REACH,
    BACK,
    ROUND,
    FACE_SIZE,
) = (0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13)
# m: the edges of pads and walls are no sharper, and no gap of theirs is known better
ROUNDED = 1e-6
LAST_STRIP = 0.01  # of half a face: what is left over a wall that gives way when the face leaves it


class Body(NamedTuple):
    """Mass (kg) and inverse inertia (3,3) about the mass centre (1/(kg m2))."""

    mass: float
    inverse_inertia: np.ndarray


class Contact(NamedTuple):
    """The one law a scene uses, the others None, and where the walls it acts at stand if they are
    warm, else None."""

    impact: Impact | None
    hunt_crossley: HuntCrossley | None
    linear: Linear | None
    bow: "Bow | None"


class System(NamedTuple):
    """All records of one run; None where an effect, or the ledger, is absent. faces (f, FACE_SIZE);
    rail_start and rail_end (m) as in ``Model``. Where walls give way they stand in the place of the
    contact law."""

    payload: Body
    platform: Body | None
    faces: np.ndarray
    rail_start: float
    rail_end: float
    thrust: Thrust
    reacts_on_platform: bool
    thrust_offset: ThrustOffset | None
    contact: Contact | None
    compliance: "Compliance | None"
    friction: Friction | None
    sticking: Sticking | None
    gravity: BodyForce | None
    ledger: bool | None


def build(
    model: Model,
    ledger: bool = True,
    compliance: "Compliance | None" = None,
    bow: "Bow | None" = None,
) -> System:
    """Records of ``model`` as the kernels take them, with a contact law at rigid walls, straight or
    with a ``bow``, or with ``walls`` that give way. Without a ``ledger`` no work, loss or impulse
    is integrated."""
    contact = (
        Contact(*model.contact, bow) if model.contact is not None and compliance is None else None
    )
    return System(
        _body(model.payload),
        _body(model.platform) if model.platform is not None else None,
        _table(model, compliance),
        float(model.rail_start),
        float(model.rail_end),
        model.thrust,
        model.reacts_on_platform,
        model.thrust_offset,
        contact,
        compliance,
        _if(model.friction, Friction),
        _if(model.friction, Sticking),
        model.body_force,
        True if ledger else None,
    )


def _if(record, kind: type):
    """``record`` if it is of this kind: each law of friction has a field of its own, so that only
    it is compiled."""
    return record if isinstance(record, kind) else None


def _body(record) -> Body:
    return Body(record.mass, np.ascontiguousarray(record.inverse_inertia))


def _table(model: Model, compliance) -> np.ndarray:
    faces = model.faces
    table = np.zeros((faces.axis.size, FACE_SIZE))
    table[:, CENTRE : CENTRE + 3] = faces.centre
    table[:, NORMAL_Y] = np.where(faces.axis == 1, faces.sign, 0.0)
    table[:, NORMAL_Z] = np.where(faces.axis == 2, faces.sign, 0.0)
    table[:, WALL], table[:, HALF_LENGTH] = faces.sign * faces.wall, faces.half_length
    table[:, NUMBER] = np.arange(faces.axis.size)
    if compliance is not None:
        table[:, OVERHANG] = compliance.half[:, 0] * (1.0 - LAST_STRIP)
    table[:, SIDE_MIDDLE], table[:, SIDE_REACH] = (
        model.plate.across,
        model.plate.leg + faces.half_width,
    )
    table[:, BACK], table[:, ROUND] = model.plate.thickness, faces.relief + ROUNDED
    return table
