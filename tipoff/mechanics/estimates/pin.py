"""A rigid rocket on its last guide: a pin without play at the distance d behind the mass centre, in a slot that
holds the roll. The rates from rest after a time t, with the impulse I of the thrust along e at r from the mass centre::

    w_y = (L_y - d P_z) / (J_yy + m d^2),    w_z = (L_z + d P_y) / (J_zz + m d^2)
    L = I r x e,    P = I e + m g t

The pin takes the force P across the rail. The thrust acts along its direction at the beginning; in a launch it turns
with the rocket (``tests.exact.pivot`` has this share).
"""

import numpy as np

from tipoff.mechanics import absent
from tipoff.mechanics.model import Model


def rates(model: Model, behind: float, impulse: float, time: float) -> np.ndarray:
    """Rates (3,) in rad/s of the payload of ``model`` about a pin ``behind`` its mass centre (m), after an
    ``impulse`` (N s) of the thrust in a ``time`` (s)."""
    offset, body = absent.offset(model.thrust_offset), model.payload
    turn, push = (
        impulse * np.cross(offset.arm, offset.direction),
        impulse * np.array(offset.direction),
    )
    if model.body_force is not None:
        push += body.mass * time * np.array(model.body_force)
    moment = np.array([0.0, turn[1] - behind * push[2], turn[2] + behind * push[1]])
    return moment / (np.diag(body.inertia) + body.mass * behind**2)
