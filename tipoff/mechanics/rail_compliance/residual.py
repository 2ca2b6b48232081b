"""Displacement of the walls by pressure and by friction, without the part of the modes that vibrate."""

from typing import Any

import numpy as np

from tipoff.mechanics.rail_compliance import fewer, pairs, patterns

_ROUNDING = 1e-9  # of the norm of F: error of a zero eigenvalue due to the modes


def flexibility(own: Any, modes: int) -> np.ndarray:
    """Flexibility (s,f,m,p,p) m/N of ``own``, a ``RailCompliance`` that has one, without the part of the
    first ``modes`` of each rail. Raises ValueError if this is not positive semidefinite."""
    if modes == 0:
        return own.flexibility
    part = own.shape[..., :modes] / own.frequency[own.rail, None, :modes]
    rest = own.flexibility.copy()
    for row in own.members:
        faces = row[row >= 0]
        for few in pairs.few_stations(rest):
            here, moved = rest[few], part[few][:, faces].reshape(len(rest[few]), -1, modes)
            here[:, faces, : faces.size] -= pairs.blocks(moved @ moved.swapaxes(1, 2), faces.size)
            left, every = (pairs.of_rail(table, faces) for table in (here, own.flexibility[few]))
            norm = np.linalg.norm(every, axis=(1, 2))
            allowed = _ROUNDING * np.where(norm > 0.0, norm, 1.0)
            if not pairs.is_positive(left + allowed[:, None, None] * np.eye(left.shape[1])):
                words = "with more compliance than the wall has, expected modes of the same rail"
                raise ValueError(f"modes: given {modes} {words}")
    return rest


def along(own: Any) -> np.ndarray:
    """Shapes V (s,f,d,n) of the modes of ``own``, a ``RailCompliance``, along X; zeros if friction does not
    drive them."""
    if own.dragged_shape is None:
        stations, faces, _, modes = own.shape.shape
        return np.zeros((stations, faces, patterns.DRAGGED, modes))
    return own.dragged_shape


def dragged(own: Any, modes: int) -> np.ndarray:
    """``dragged`` (s,f,m,d,d) m/N without the part of the first ``modes`` of each rail::

        D_res = D - sum_m (W_m V_m' + V_m W_m') / (2 omega_m^2)

    with W in the first d patterns alone, as D is."""
    if modes == 0 or own.dragged_shape is None:
        return own.dragged
    count = min(patterns.DRAGGED, own.shape.shape[2])
    moved = np.zeros(own.dragged_shape[..., :modes].shape)
    moved[:, :, :count] = fewer.projection(own, count) @ own.shape[..., :modes]
    moved /= own.frequency[own.rail, None, :modes] ** 2
    swept, rest = own.dragged_shape[..., :modes], own.dragged.copy()
    for row in own.members:
        faces = row[row >= 0]
        one, other = (each[:, faces].reshape(len(rest), -1, modes) for each in (moved, swept))
        part = one @ other.swapaxes(1, 2)
        part = 0.5 * (part + part.swapaxes(1, 2))
        rest[:, faces, : faces.size] -= pairs.blocks(part, faces.size)
    return rest
