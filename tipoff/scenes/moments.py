"""Moment impulse of a thrust off the mass centre, for arrays of cases.

Thrust along the unit vector f through the point r, relative to the mass centre, gives a free
payload the moment impulse::

    L = J (r x f),   J = integral of F dt
    f = (cos t, sin t cos p, sin t sin p),   r = (-arm, e sin a - m sin b, e cos a - m cos b)

with misalignment t at p, thrust eccentricity e at a and mass eccentricity m at b, the angles of
``scenes.effects``; here as arrays.
"""

from collections.abc import Mapping

import numpy as np

from tipoff.scenes import overrides, polar

Inputs = Mapping[str, np.ndarray]


def column(scene, inputs: Inputs, key: str) -> np.ndarray | float:
    """The numbers (n,) under a dotted ``key`` in ``inputs``, SI. Cases without one (NaN) have the
    scene's value, zero if it has none."""
    own = overrides.held(scene, key)
    own = 0.0 if own is None else own
    values = inputs.get(key)
    return own if values is None else np.where(np.isnan(values), own, values)


def moment_impulses(scene, inputs: Inputs, impulse: np.ndarray | float) -> np.ndarray:
    """Moment impulses (n,3) or (3,) in N m s, body axes, about the mass centre, of variations of
    ``scene`` by ``inputs`` (n,), SI, with the ``impulse`` (n,) in N s of their thrusts."""

    def offset(table: str) -> tuple:
        size, angle = (
            column(scene, inputs, f"{table}.eccentricity.{name}") for name in ("axial", "radial")
        )
        return polar.offset(size, angle, np)

    (thrust_y, thrust_z), (centre_y, centre_z) = offset("thrust_offset"), offset("mass_offset")
    tilt, turn = (
        column(scene, inputs, f"thrust_offset.misalignment.{name}") for name in ("axial", "radial")
    )
    arm = column(scene, inputs, "thrust.arm")
    middle_y, middle_z = scene.thrust.middle()
    place = np.broadcast_arrays(
        -arm, thrust_y + middle_y - centre_y, thrust_z + middle_z - centre_z
    )
    direction = np.broadcast_arrays(*polar.direction(tilt, turn, np))
    return np.asarray(impulse)[..., None] * np.cross(
        np.stack(place, axis=-1), np.stack(direction, axis=-1)
    )


def transverse(scene, inputs: Inputs, impulse: np.ndarray | float) -> np.ndarray:
    """Magnitude (n,) or () of the moment impulse across the axis, |L_yz| in N m s."""
    return np.hypot(*np.moveaxis(moment_impulses(scene, inputs, impulse)[..., 1:], -1, 0))
