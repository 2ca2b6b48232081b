"""Records of a scene for the kernels of the surrogate; the faces are one table."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.kernels.reference import by_reference
from tipoff.mechanics.model import Model
from tipoff.scenes.effects.body_force import BodyForce
from tipoff.scenes.effects.contact import HuntCrossley, Impact, Linear
from tipoff.scenes.effects.friction import Friction
from tipoff.scenes.effects.sticking import Sticking
from tipoff.scenes.effects.thrust_law import Thrust
from tipoff.scenes.effects.thrust_offset import ThrustOffset

if TYPE_CHECKING:
    from tipoff.lowfi.contact.compliant.neglected import Neglected
    from tipoff.lowfi.contact.compliant.record import Compliance
    from tipoff.lowfi.contact.thermal_offset import ThermalOffset

# Columns of the table of faces: centre in payload body axes (m); outward normal's y and z and the
# wall's distance along it (m), in platform axes; half the length (m); its own number; and for the
# ends of the wall (``lowfi.contact.wall_ends``): how far (m) the middle of the face may be beyond an
# end of the rail, its place across the rail when centred (m, platform axes), how far from there it
# may be (m), the thickness of the wall (m), and how deep (m) its edge may pass that of the wall.
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
ROUNDED = 1e-6  # m: edges of pads and walls are no sharper, and no gap is more accurate
LAST_STRIP = 0.01  # of half a face: what is still over a compliant wall when the face leaves it


@by_reference
class Body(NamedTuple):
    """A rigid body."""

    mass: float  # kg
    inverse_inertia: np.ndarray  # (3, 3) 1/(kg m2), about the mass centre, in body axes


@by_reference
class Contact(NamedTuple):
    """The one contact law of a scene; the other laws are None."""

    impact: Impact | None
    hunt_crossley: HuntCrossley | None
    linear: Linear | None
    thermal_offset: "ThermalOffset | None"  # of the walls, None where they are not warm


@by_reference
class System(NamedTuple):
    """All records of one run; None where an effect is absent."""

    payload: Body
    platform: Body | None  # None where the rails are fixed
    faces: np.ndarray  # (f, FACE_SIZE)
    rail_start: float  # m, X of the rear end
    rail_end: float  # m, X of the open end
    thrust: Thrust
    reacts_on_platform: bool  # whether the platform takes the reaction of the thrust
    thrust_offset: ThrustOffset | None
    contact: Contact | None  # contact springs
    compliance: "Compliance | None"  # compliant contact, instead of contact springs
    has_contact: bool  # of either kind
    # True with a compliance, else None: a small argument by which functions are pruned
    is_compliant: bool | None
    friction: Friction | None  # two-step law
    sticking: Sticking | None  # stick-slip law
    body_force: BodyForce | None
    ledger: bool | None  # True where work, losses and impulses are integrated
    neglected: "Neglected | None"  # modes of the rails that are watched, None at rigid walls


def build(
    model: Model,
    ledger: bool = True,
    compliance: "Compliance | None" = None,
    thermal_offset: "ThermalOffset | None" = None,
    neglected: "Neglected | None" = None,
) -> System:
    """Records of ``model``: contact springs at rigid walls, with a ``thermal_offset`` or without,
    or compliant contact with a ``compliance``. Without a ``ledger`` no work, loss or impulse is
    integrated. Of ``neglected`` modes the effect is found."""
    contact, friction = None, model.friction
    if model.contact is not None and compliance is None:
        contact = Contact(*model.contact, thermal_offset)
    return System(
        payload=_body(model.payload),
        platform=_body(model.platform) if model.platform is not None else None,
        faces=_table(model, compliance),
        rail_start=float(model.rail_start),
        rail_end=float(model.rail_end),
        thrust=model.thrust,
        reacts_on_platform=model.reacts_on_platform,
        thrust_offset=model.thrust_offset,
        contact=contact,
        compliance=compliance,
        has_contact=contact is not None or compliance is not None,
        is_compliant=True if compliance is not None else None,
        # a field for each law, so that only the law in use is compiled
        friction=friction if isinstance(friction, Friction) else None,
        sticking=friction if isinstance(friction, Sticking) else None,
        body_force=model.body_force,
        ledger=True if ledger else None,
        neglected=neglected,
    )


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
