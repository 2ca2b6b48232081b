"""Forces of the joints between rail and platform (``scenes.effects.mount_stiffness``) on the nodes
of the mount strips.

    r += S u

``statics.mounts`` defines S. Its block for two nodes of a strip across an axis is diagonal; on an
oblique strip it is not. Both are stored apart. Unlike K u, S u has a resultant and a moment about
the undeformed places. Their opposites act on the frame. They are summed here node by node; ``step``
has the rest of the balance.
"""

import numpy as np
from scipy.sparse import csr_array

from tipoff.highfi.state.pose import plus, triple
from tipoff.highfi.state.records import Mounts
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel

_ROUNDING = 1e-14  # of the largest number; a smaller one off the diagonals is zero


def build(matrix: csr_array | None, number: np.ndarray, blocks: np.ndarray) -> Mounts:
    """Kernel record of the stiffness ``matrix`` (3n,3n) N/m between mesh nodes with the ``number``
    (n,) in the nodal arrays, and the first node (b+1,) of the ``blocks``; no nodes without joints."""
    if matrix is None:
        return _none(blocks.size)
    by_node = matrix.tobsr(blocksize=(3, 3))
    own = np.flatnonzero(np.diff(by_node.indptr))
    own = own[np.argsort(number[own])]
    counts = np.diff(by_node.indptr)[own]
    ends = np.cumsum(counts)
    pair = np.repeat(by_node.indptr[own] - ends + counts, counts) + np.arange(ends[-1])
    neighbour, stiffness = number[by_node.indices[pair]].astype(np.uint32), by_node.data[pair]
    diagonal = np.einsum("pii->pi", stiffness)
    beside = np.abs(stiffness - diagonal[:, :, None] * np.eye(3)).max(axis=(1, 2))
    mixed = beside > _ROUNDING * np.abs(stiffness).max()
    of_node = np.repeat(np.arange(own.size), counts)

    def first(chosen: np.ndarray) -> np.ndarray:
        return np.searchsorted(of_node[chosen], np.arange(own.size + 1)).astype(np.uint64)

    return Mounts(
        node=number[own].astype(np.uint32),
        first_node=np.searchsorted(number[own], blocks).astype(np.uint64),
        first=first(~mixed),
        neighbour=neighbour[~mixed],
        stiffness=diagonal[~mixed],
        first_mixed=first(mixed),
        mixed_neighbour=neighbour[mixed],
        mixed_stiffness=stiffness[mixed],
    )


def _none(blocks: int) -> Mounts:
    none, one = np.zeros(0, dtype=np.uint32), np.zeros(1, dtype=np.uint64)
    return Mounts(
        node=none,
        first_node=np.zeros(blocks, dtype=np.uint64),
        first=one,
        neighbour=none,
        stiffness=np.zeros((0, 3)),
        first_mixed=one,
        mixed_neighbour=none,
        mixed_stiffness=np.zeros((0, 3, 3)),
    )


@kernel
def add_mounts(mounts, rail, displacement, force, block, turn, total):
    """Add S u to the ``force`` of the nodes of ``block``, their u x S u to ``turn`` (3,), and set
    ``total`` (b,6) of the block to the resultant of S u and its moment about the frame's origin."""
    # numbers, because the compiler cannot know that arrays do not overlap
    turning, resultant, whole = triple(turn), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(mounts.first_node[block], mounts.first_node[block + 1]):
        node, f = mounts.node[k], _force(mounts, displacement, k)
        turning = plus(turning, rotation.cross(triple(displacement[node]), f))
        resultant = plus(resultant, f)
        whole = plus(whole, rotation.cross(triple(rail.points[node]), f))
        for i in range(3):
            force[node, i] += f[i]
    for i in range(3):
        turn[i] = turning[i]
        total[block, i], total[block, 3 + i] = resultant[i], whole[i]


@kernel
def _force(mounts, displacement, k):
    x, y, z = 0.0, 0.0, 0.0
    after = k + np.uint64(1)
    for q in range(mounts.first[k], mounts.first[after]):
        u = triple(displacement[mounts.neighbour[q]])
        x += mounts.stiffness[q, 0] * u[0]
        y += mounts.stiffness[q, 1] * u[1]
        z += mounts.stiffness[q, 2] * u[2]
    for q in range(mounts.first_mixed[k], mounts.first_mixed[after]):
        u, s = triple(displacement[mounts.mixed_neighbour[q]]), mounts.mixed_stiffness[q]
        x += s[0, 0] * u[0] + s[0, 1] * u[1] + s[0, 2] * u[2]
        y += s[1, 0] * u[0] + s[1, 1] * u[1] + s[1, 2] * u[2]
        z += s[2, 0] * u[0] + s[2, 1] * u[1] + s[2, 2] * u[2]
    return x, y, z


@kernel
def collect_mounts(mounts, state):
    """Add the forces of the joints on the frame to ``state.reaction``."""
    if mounts.node.size > 0:
        for block in range(state.mounting.shape[0]):
            for i in range(6):
                state.reaction[i] -= state.mounting[block, i]


@kernel
def damp_mounts(mounting, history, block, stiff):
    """Add the resultant of the damping of the joints, ``stiff`` (beta / dt) times the change of
    their force over the step, to ``history.drag``; ``begin_mounts`` sets the force before."""
    for i in range(6):
        history.drag[block, i] += stiff * (mounting[block, i] - history.mounting[block, i])
        history.mounting[block, i] = mounting[block, i]


@kernel
def begin_mounts(mounting, history):
    """Set the forces of the step before to the present ones: rails at rest in their frame."""
    for block in range(mounting.shape[0]):
        for i in range(6):
            history.mounting[block, i] = mounting[block, i]
