"""Fields of a rail compliance that is larger by its own uncertainty."""

from typing import Any

import numpy as np

from tipoff.mechanics.rail_compliance import pairs


def softened(own: Any) -> dict[str, Any]:
    """Fields that change if the compliance of each face of ``own``, a ``RailCompliance``, is larger by
    its uncertainty U, and the frequency of each mode lower by its own v::

        F_ij -> F_ij ((1 + U_i) (1 + U_j))^1/2,   omega -> omega / (1 + v),   W_i -> W_i (1 + U_i)^1/2 / (1 + v)

    and V as W.

    The compliance without the part of any modes grows by the same factors, so it stays positive.
    """
    stretch = np.sqrt(1.0 + own.uncertainty)
    slower = 1.0 + own.frequency_uncertainty
    by_mode = stretch[:, None, None] / slower

    def grown(table: np.ndarray) -> np.ndarray:
        factors = stretch[:, None, None] * np.eye(table.shape[-1])
        each = np.broadcast_to(factors, (len(table), *factors.shape))
        return pairs.on_both_sides(each, table, own.rail)

    return {
        "flexibility": grown(own.flexibility),
        "dragged": None if own.dragged is None else grown(own.dragged),
        "frequency": own.frequency / slower,
        "shape": own.shape * by_mode,
        "dragged_shape": None if own.dragged_shape is None else own.dragged_shape * by_mode,
        "joints": None,
        "find_joints": None,
        "nodes": None,
    }
