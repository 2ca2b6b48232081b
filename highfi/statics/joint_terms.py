"""Solutions that ``mechanics.rail_compliance.joint_terms`` needs for the compliance of a rail on joints with any
factor of their stiffness."""

from collections.abc import Iterable
from functools import reduce
from typing import NamedTuple

import numpy as np
from scipy.linalg import cholesky, eigh, svd
from scipy.sparse import csc_array

from tipoff.highfi.statics import vibration
from tipoff.highfi.statics.assembly import Operator
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.rail_compliance.joint_terms import LEAST, MOST, TERMS, JointTerms

_BATCH = 64  # loads solved for at once; bounds the memory


class Loads(NamedTuple):
    """Nodal loads (N) of one rail."""

    pressure: csc_array  # (3n,l)
    drag: csc_array  # (3n,d) traction along X
    heat: np.ndarray  # (3n,t) thermal


class Terms(NamedTuple):
    """Terms and shapes of one rail under l loads; see ``JointTerms``."""

    share: np.ndarray  # (n,)
    moved: np.ndarray  # (l,n)
    moved_by_friction: np.ndarray  # (d,n)
    heated: np.ndarray  # (n,t)
    shape: np.ndarray  # (l,m)
    dragged_shape: np.ndarray  # (d,m)
    stiffness: np.ndarray  # (m,m)
    joint: np.ndarray  # (m,m)


def solved(
    operator: Operator,
    held: Clamped,
    loads: Loads,
    modes: np.ndarray,
    direct: np.ndarray,
) -> Terms:
    """Terms of a rail that only its joints hold, under nodal ``loads``, with its ``modes``
    (3n,c); ``direct`` (l,) m is the displacement of each pressure under itself."""
    assert operator.joints is not None
    joints = operator.joints
    own = np.flatnonzero(np.diff(joints.indptr))
    root = cholesky(joints[own][:, own].toarray(), lower=True)
    moved, dragged, heated = (np.empty((each.shape[1], own.size)) for each in loads)
    inner = np.empty((own.size, own.size))
    for start in range(0, own.size, _BATCH):
        part = slice(start, start + _BATCH)
        right = np.zeros((joints.shape[0], root[:, part].shape[1]))
        right[own] = root[:, part]
        answer = held.solve(right)
        for found, each in zip((moved, dragged, heated), loads):
            found[:, part] = each.T @ answer
        inner[part] = answer[own].T @ root
    share, turn = eigh(0.5 * (inner + inner.T))
    moved, dragged, heated = moved @ turn, dragged @ turn, heated @ turn
    kept = _large(moved, direct)
    basis = _basis(operator, modes)
    return Terms(
        share=share[kept],
        moved=moved[:, kept],
        moved_by_friction=dragged[:, kept],
        heated=heated[:, kept].T,
        shape=loads.pressure.T @ basis,
        dragged_shape=loads.drag.T @ basis,
        stiffness=basis.T @ (held.stiffness @ basis),
        joint=basis.T @ (joints @ basis),
    )


def _large(moved: np.ndarray, direct: np.ndarray) -> np.ndarray:
    """Numbers of the terms to keep: the others hold at most ``TERMS`` of the displacement of any
    load. A weight h is at most 1 / LEAST - 1."""
    relative = moved**2 / direct[:, None]
    order = np.argsort(relative.max(axis=0))
    dropped = np.cumsum(relative[:, order], axis=1).max(axis=0) * (1.0 / LEAST - 1.0) < TERMS
    return np.sort(order[~dropped])


def _basis(operator: Operator, modes: np.ndarray) -> np.ndarray:
    """Shapes (3n,m) of unit modal mass, orthogonal to each other. Their space contains the
    ``modes`` (3n,c) and the modes at the least and the largest factor."""
    mass, joints = np.repeat(operator.mass, 3), operator.joints
    assert joints is not None
    found = [modes]
    for factor in (LEAST, MOST):
        other = Clamped(operator._replace(joints=factor * joints), 8 * modes.shape[1])
        found.append(vibration.modes(other.stiffness, mass, other.solve, modes.shape[1])[1])
    root = np.sqrt(mass)[:, None]
    return svd(root * np.concatenate(found, axis=1), full_matrices=False)[0] / root


class Part(NamedTuple):
    """One rail with faces."""

    number: np.ndarray  # (s,f) place under each face, -1 without one
    signs: np.ndarray  # (3,) of its image
    terms: Terms


def together(parts: list[Part], patterns: int, dragged: int) -> JointTerms:
    """Terms of rails in their order; faces have so many ``patterns``, and ``dragged`` ones."""
    most = max(part.terms.share.size for part in parts)

    def padded(values: np.ndarray, axis: int) -> np.ndarray:
        width = [(0, 0)] * values.ndim
        width[axis] = (0, most - values.shape[axis])
        return np.pad(values, width)

    def under(part: Part, values: np.ndarray, own: int = patterns) -> np.ndarray:
        places = values.reshape(len(part.terms.moved) // patterns, own, values.shape[1])
        # an additional last place without displacement, for faces without a wall (number -1)
        return np.pad(places, [(0, 1), (0, 0), (0, 0)])[part.number]

    return JointTerms(
        share=np.array([padded(part.terms.share, 0) for part in parts]),
        moved=_sum(under(part, padded(part.terms.moved, 1)) for part in parts),
        moved_first=_sum(
            under(part, padded(part.terms.moved, 1))[:, :, :dragged] for part in parts
        ),
        moved_by_friction=_sum(
            under(part, padded(part.terms.moved_by_friction, 1), dragged) for part in parts
        ),
        heated=np.array(
            [padded(part.terms.heated * np.r_[1.0, part.signs, 1.0], 0) for part in parts]
        ),
        shape=_sum(under(part, part.terms.shape) for part in parts),
        dragged_shape=_sum(under(part, part.terms.dragged_shape, dragged) for part in parts),
        stiffness=np.array([part.terms.stiffness for part in parts]),
        joint=np.array([part.terms.joint for part in parts]),
    )


def _sum(arrays: Iterable[np.ndarray]) -> np.ndarray:
    """Sum of arrays of one shape."""
    return reduce(np.add, arrays)
