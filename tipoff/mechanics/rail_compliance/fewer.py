"""Fields of a rail compliance for fewer patterns than its own."""

from typing import Any

import numpy as np

from tipoff.mechanics.rail_compliance import pairs, patterns


def of_first(own: Any, count: int) -> dict[str, Any]:
    """Fields that change if loads are in the first ``count`` patterns of ``own``, a
    ``RailCompliance``, and displacements projected on them."""
    flexibility, dragged, dragged_shape = own.flexibility, own.dragged, own.dragged_shape
    onto, inside = projection(own, count), np.arange(patterns.DRAGGED) < count
    if flexibility is not None:
        flexibility = pairs.on_both_sides(onto, flexibility, own.rail)
    if dragged is not None:
        dragged = dragged * inside[:, None] * inside
    if dragged_shape is not None:
        dragged_shape = dragged_shape * inside[:, None]
    return {
        "flexibility": flexibility,
        "dragged": dragged,
        "dragged_shape": dragged_shape,
        "shape": onto @ own.shape,
        "warm": None if own.warm is None else np.einsum("siab,tsib->tsia", onto, own.warm),
        "joints": None,
        "find_joints": None,
        "nodes": None,
    }


def projection(own: Any, count: int) -> np.ndarray:
    """Matrices (s,f,c,p) from displacements in the patterns of ``own`` to those in the first ``count``
    alone, which have the same means with these."""
    gram = own.gram[..., :count, :]
    return np.linalg.inv(gram[..., :count]) @ gram


def restricted(own: Any, count: int, coupled: bool) -> dict[str, Any]:
    """Fields that change in a model of the first ``count`` patterns of the same degree; unless
    ``coupled``, without the coupling between faces, modes and friction on the walls."""
    first = of_first(own, count)
    flexibility, shape = np.zeros_like(own.flexibility), np.zeros_like(own.shape)
    flexibility[..., :count, :count] = first["flexibility"]
    shape[:, :, :count] = first["shape"]
    found = first | {"flexibility": flexibility, "shape": shape, "warm": own.warm}
    if coupled:
        return found
    alone = pairs.beside(own.rail) == np.arange(len(own.rail))[:, None]
    return found | {
        "flexibility": flexibility * alone[:, :, None, None],
        "dragged": None,
        "dragged_shape": None,
        "frequency": own.frequency[:, :0],
        "shape": shape[..., :0],
    }
