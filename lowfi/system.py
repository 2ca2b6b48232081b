"""Records of a scene for the kernels of the surrogate."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.reference import by_reference
from tipoff.lowfi import faces
from tipoff.lowfi.contact.compliant.neglected import Neglected
from tipoff.lowfi.contact.compliant.record import Compliance
from tipoff.lowfi.contact.thermal_offset import ThermalOffset
from tipoff.lowfi.pushers import Pushing, pushing
from tipoff.mechanics.scene_model import Model
from tipoff.scenes.effects.body_force import BodyForce
from tipoff.scenes.effects.contact import ContactLaw
from tipoff.scenes.effects.friction import Friction
from tipoff.scenes.effects.hold_down import HoldDown
from tipoff.scenes.effects.sticking import Sticking
from tipoff.scenes.effects.thrust_law import Thrust
from tipoff.scenes.effects.thrust_offset import ThrustOffset


@by_reference
class Body(NamedTuple):
    """A rigid body."""

    mass: float  # kg
    inertia: np.ndarray  # (3, 3) kg m2, about the mass centre, in body axes
    inverse_inertia: np.ndarray  # (3, 3) 1/(kg m2)


@by_reference
class Contact(NamedTuple):
    """Contact springs."""

    law: ContactLaw
    thermal_offset: ThermalOffset | None  # of the walls, None if they are not warm


@by_reference
class System(NamedTuple):
    """All records of one run; None for an absent effect."""

    payload: Body
    platform: Body | None  # None for fixed rails
    faces: np.ndarray  # (f, faces.FACE_SIZE)
    rail_start: float  # m, X of the rear end
    rail_end: float  # m, X of the open end
    thrust: Thrust  # over time
    pushing: Pushing | None  # thrust over travel
    reacts_on_platform: bool  # whether the platform takes the reaction of the thrust
    thrust_offset: ThrustOffset | None
    hold_down: HoldDown | None
    contact: Contact | None  # contact springs
    compliance: Compliance | None  # compliant contact, instead of contact springs
    has_contact: bool  # of either kind
    # True with a compliance, else None: a small argument that removes code at compile time
    is_compliant: bool | None
    friction: Friction | None  # two-step law
    sticking: Sticking | None  # stick-slip law
    body_force: BodyForce | None
    ledger: bool | None  # True if work, losses and impulses are integrated
    neglected: Neglected | None  # watched modes of the rails, None at rigid walls


def build(
    model: Model,
    ledger: bool = True,
    compliance: Compliance | None = None,
    thermal_offset: ThermalOffset | None = None,
    neglected: Neglected | None = None,
) -> System:
    """Records of ``model``: contact springs at rigid walls, with or without a ``thermal_offset``,
    or compliant contact with a ``compliance``. Without a ``ledger`` no work, loss or impulse is
    integrated. The effect of ``neglected`` modes is computed."""
    contact, friction = None, model.friction
    if model.contact is not None and compliance is None:
        contact = Contact(law=model.contact, thermal_offset=thermal_offset)
    return System(
        payload=_body(model.payload),
        platform=_body(model.platform) if model.platform is not None else None,
        faces=faces.table(model, compliance),
        rail_start=float(model.rail_start),
        rail_end=float(model.rail_end),
        thrust=model.thrust,
        pushing=pushing(model.pushers),
        reacts_on_platform=model.reacts_on_platform,
        thrust_offset=model.thrust_offset,
        hold_down=model.hold_down,
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
    return Body(
        record.mass,
        np.ascontiguousarray(record.inertia),
        np.ascontiguousarray(record.inverse_inertia),
    )
