"""Records of a scene for the kernels of the surrogate."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.reference import by_reference
from tipoff.lowfi import faces
from tipoff.lowfi.contact.compliant.neglected import Neglected
from tipoff.lowfi.contact.compliant.record import Compliance
from tipoff.lowfi.contact.thermal_offset import ThermalOffset
from tipoff.lowfi.pushers import Pushing, pushing
from tipoff.mechanics import ledger
from tipoff.mechanics.absent import NO_FORCE, NO_LATCH, NO_PUSHERS, SMOOTH, Offset, offset
from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.mechanics.laws.contact import NO_CONTACT, ContactLaw
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.sticking import Sticking
from tipoff.mechanics.laws.thrust import Thrust, complete
from tipoff.mechanics.model import Model

# Effects whose evaluations a run counts.
(
    BODY_FORCE,
    COMPLIANCE,
    CONTACT,
    FRICTION,
    HOLD_DOWN,
    MODES,
    PLATFORM,
    PUSHERS,
    STICKING,
    THERMAL,
    THRUST_OFFSET,
) = range(11)
COUNTED = (
    ledger.BODY_FORCE,
    "compliance",
    "contact",
    "friction",
    "hold_down",
    "modes",
    "platform",
    "pushers",
    "sticking",
    "thermal",
    "thrust_offset",
)
_NO_STICKING = Sticking(static=0.0, dynamic=0.0, stiffness=0.0, damping=0.0, capture_speed=1.0)


@by_reference
class Body(NamedTuple):
    """A rigid body."""

    mass: float  # kg
    inertia: np.ndarray  # (3, 3) kg m2, about the mass centre, in body axes
    inverse_inertia: np.ndarray  # (3, 3) 1/(kg m2)
    free: bool  # False for the platform of fixed rails


# The platform of fixed rails: it does not move, whatever acts on it.
_FIXED = Body(np.inf, np.zeros((3, 3)), np.zeros((3, 3)), free=False)


@by_reference
class Contact(NamedTuple):
    """Contact springs."""

    law: ContactLaw
    # of the walls; None is a type, because a flag costs springs a tenth of their time
    thermal_offset: ThermalOffset | None
    sticking: Sticking  # stick-slip law


@by_reference
class System(NamedTuple):
    """All records of one run. The kernels skip an absent effect by its record: no free platform, no
    pusher, no friction, no offset. None is a type of its own, for which kernels are compiled: the
    kind of contact that is not there, and springs at straight walls."""

    payload: Body
    platform: Body
    faces: np.ndarray  # (f, faces.FACE_SIZE)
    rail_start: float  # m, X of the rear end
    rail_end: float  # m, X of the open end
    thrust: Thrust  # over time
    pushing: Pushing  # thrust over travel
    reacts_on_platform: bool  # whether the platform takes the reaction of the thrust
    thrust_offset: Offset
    hold_down: HoldDown
    contact: Contact | None  # contact springs; None for compliant contact
    compliance: Compliance | None  # compliant contact, instead of contact springs
    has_contact: bool  # of either kind
    # True with a compliance, else None: a small argument that removes code at compile time
    is_compliant: bool | None
    friction: Friction  # two-step law
    body_force: BodyForce
    evaluated: np.ndarray  # (n,) how often the law of each effect of ``COUNTED`` was evaluated
    neglected: Neglected | None  # watched modes of the rails, None at rigid walls


def build(
    model: Model,
    compliance: Compliance | None = None,
    thermal_offset: ThermalOffset | None = None,
    neglected: Neglected | None = None,
) -> System:
    """Records of ``model``: contact springs at rigid walls, with or without a ``thermal_offset``,
    or compliant contact with a ``compliance``. The effect of ``neglected`` modes is computed."""
    contact, friction = None, model.friction
    if compliance is None:
        contact = Contact(
            law=model.contact or NO_CONTACT,
            thermal_offset=thermal_offset,
            sticking=friction if isinstance(friction, Sticking) else _NO_STICKING,
        )
    return System(
        payload=_body(model.payload),
        platform=_body(model.platform) if model.platform is not None else _FIXED,
        faces=faces.table(model, compliance),
        rail_start=float(model.rail_start),
        rail_end=float(model.rail_end),
        thrust=complete(model.thrust),
        pushing=pushing(model.pushers or NO_PUSHERS),
        reacts_on_platform=model.reacts_on_platform,
        thrust_offset=offset(model.thrust_offset),
        hold_down=model.hold_down or NO_LATCH,
        contact=contact,
        compliance=compliance,
        has_contact=model.contact is not None or compliance is not None,
        is_compliant=True if compliance is not None else None,
        friction=friction if isinstance(friction, Friction) else SMOOTH,
        body_force=model.body_force or NO_FORCE,
        evaluated=np.zeros(len(COUNTED), dtype=np.int64),
        neglected=neglected,
    )


def _body(record) -> Body:
    return Body(
        record.mass,
        np.ascontiguousarray(record.inertia),
        np.ascontiguousarray(record.inverse_inertia),
        free=True,
    )
