"""Forces of the joints between rail and platform (``scenes.effects.mount_stiffness``) on the nodes
of the mount strips.

    r += S u

``statics.mounts`` defines S. Unlike K u, S u has a resultant and a moment about the undeformed
places. Their opposites act on the frame. They are summed here node by node; ``step`` has the rest
of the balance.
"""

import numpy as np
from scipy.sparse import csr_array

from tipoff.highfi.state.pose import triple
from tipoff.highfi.state.records import Mounts
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel


def build(matrix: csr_array | None, number: np.ndarray, blocks: np.ndarray) -> Mounts | None:
    """Kernel record of the stiffness ``matrix`` (3n,3n) N/m between mesh nodes with the ``number``
    (n,) in the nodal arrays, and the first node (b+1,) of the ``blocks``; None without joints."""
    if matrix is None:
        return None
    by_node = matrix.tobsr(blocksize=(3, 3))
    own = np.flatnonzero(np.diff(by_node.indptr))
    own = own[np.argsort(number[own])]
    counts = np.diff(by_node.indptr)[own]
    first = np.concatenate([[0], np.cumsum(counts)])
    place = np.repeat(by_node.indptr[own] - first[:-1], counts) + np.arange(first[-1])
    return Mounts(
        node=number[own],
        first_node=np.searchsorted(number[own], blocks),
        first=first,
        neighbour=number[by_node.indices[place]],
        stiffness=np.ascontiguousarray(by_node.data[place]),
    )


@kernel
def add_mounts(mounts, rail, displacement, force, block, turn, total):
    """Add S u to the ``force`` of the nodes of ``block``, their u x S u to ``turn`` (3,), and set
    ``total`` (b,6) of the block to the resultant of S u and its moment about the frame's origin;
    not compiled when ``mounts`` is None."""
    if mounts is not None:
        total[block, :] = 0.0
        for k in range(mounts.first_node[block], mounts.first_node[block + 1]):
            node, f = mounts.node[k], _force(mounts, displacement, k)
            own = rotation.cross(triple(displacement[node]), f)
            moment = rotation.cross(triple(rail.points[node]), f)
            for i in range(3):
                force[node, i] += f[i]
                turn[i] += own[i]
                total[block, i] += f[i]
                total[block, 3 + i] += moment[i]


@kernel
def _force(mounts, displacement, k):
    x, y, z = 0.0, 0.0, 0.0
    for q in range(mounts.first[k], mounts.first[k + 1]):
        u, s = triple(displacement[mounts.neighbour[q]]), mounts.stiffness[q]
        x += s[0, 0] * u[0] + s[0, 1] * u[1] + s[0, 2] * u[2]
        y += s[1, 0] * u[0] + s[1, 1] * u[1] + s[1, 2] * u[2]
        z += s[2, 0] * u[0] + s[2, 1] * u[1] + s[2, 2] * u[2]
    return x, y, z


@kernel
def collect_mounts(mounting, state):
    """Add the forces of the joints on the frame to ``state.reaction``."""
    if mounting is not None:
        for block in range(mounting.shape[0]):
            for i in range(6):
                state.reaction[i] -= mounting[block, i]


@kernel
def damp_mounts(mounting, history, block, stiff):
    """Add the resultant of the damping of the joints, ``stiff`` (beta / dt) times the change of
    their force over the step, to ``history.drag``; ``begin_mounts`` sets the force before."""
    if mounting is not None:
        for i in range(6):
            history.drag[block, i] += stiff * (mounting[block, i] - history.mounting[block, i])
            history.mounting[block, i] = mounting[block, i]


@kernel
def begin_mounts(mounting, history):
    """Set the forces of the step before to the present ones: rails at rest in their frame."""
    if mounting is not None:
        for block in range(mounting.shape[0]):
            for i in range(6):
                history.mounting[block, i] = mounting[block, i]
