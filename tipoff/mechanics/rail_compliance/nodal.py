"""The tables of a long rail from the displacements of the few nodes that its pads press.

A place of a pad is on a few nodes of the wall, and many places are on the same ones. With the loads E' of
a face on its nodes, which are the displacements E of the face too, and G between nodes::

    F_ij = E_i G E_j',   T_ij = E_i G_x E_j',   W_i = E_i psi,   V_i = E_i psi_x,   T_i = E_i w

for pressure, for traction along X, in the modes, along X in the modes, and by each thermal field.
On an extruded rail E is a product of a function of the place along the rail and one of the place across it:
a few shapes span it. So a file holds G, and E by these shapes, in place of the tables between all faces at
all stations.
"""

from typing import NamedTuple

import numpy as np

from tipoff.mechanics.rail_compliance import pairs
from tipoff.mechanics.rail_compliance.patterns import DRAGGED

_SPANNED = 1e-14  # of the largest shape: smaller ones are rounding


class Spanned(NamedTuple):
    """Matrices E (s,f,p,n) on n nodes, k times the same number, as sums of few shapes."""

    share: np.ndarray  # (f,s,k,r)
    shape: np.ndarray  # (f,r,p n/k)

    def matrices(self, patterns: int) -> np.ndarray:
        """E (s,f,p,n)."""
        faces, stations, lines, _ = self.share.shape
        found = self.share.reshape(faces, stations * lines, -1) @ self.shape
        found = found.reshape(faces, stations, lines, patterns, -1).transpose(1, 0, 3, 2, 4)
        return np.ascontiguousarray(found).reshape(stations, faces, patterns, -1)


def spanned(matrices: np.ndarray, lines: int) -> Spanned:
    """The fewest shapes of ``matrices`` (s,f,p,n) on nodes of so many ``lines`` across the rail."""
    stations, faces, patterns, nodes = matrices.shape
    each = matrices.reshape(stations, faces, patterns, lines, nodes // lines)
    rows = each.transpose(1, 0, 3, 2, 4).reshape(faces, stations * lines, -1)
    left, size, shape = np.linalg.svd(rows, full_matrices=False)
    count = max(int((size > _SPANNED * size[:, :1]).sum(axis=1).max()), 1)
    share = (left[..., :count] * size[:, None, :count]).reshape(faces, stations, lines, count)
    return Spanned(share, shape[:, :count])


class Tables(NamedTuple):
    """Fields of a ``RailCompliance``."""

    flexibility: np.ndarray
    dragged: np.ndarray
    shape: np.ndarray
    dragged_shape: np.ndarray
    warm: np.ndarray


class Nodal(NamedTuple):
    """Displacements of u degrees of freedom of one rail, by layers of the rail, and the faces on them."""

    # (s,f,n) numbers of the degrees of freedom of the nodes under each face: normal to it, and along X
    normal: np.ndarray
    along: np.ndarray
    share: np.ndarray  # (f,s,k,r) and (f,r,p n/k): E for all patterns (``Spanned``)
    shape: np.ndarray
    share_first: np.ndarray  # likewise, for those that friction drags
    shape_first: np.ndarray
    starts: np.ndarray  # (l+1,) number of the first degree of freedom of each layer
    layers: np.ndarray  # (q,2) numbers of two layers, the first one not above the second
    blocks: np.ndarray  # (q,w,w) m/N, G between them
    swung: np.ndarray  # (u,m) 1/kg^0.5, psi
    heated: np.ndarray  # (u,t) m, w
    signs: np.ndarray  # (f,t) of each thermal field on the rail of a face
    toward: np.ndarray  # (f,) sign of the axis along which each face presses

    @property
    def patterns(self) -> int:
        """Number p of patterns."""
        return self.shape.shape[2] * self.share.shape[2] // self.normal.shape[2]

    def tables(self, rail: np.ndarray) -> Tables:
        """The tables for faces each on its ``rail`` (f,)."""
        patterns, dragged = self.patterns, DRAGGED
        every = Spanned(self.share, self.shape).matrices(patterns)
        first = Spanned(self.share_first, self.shape_first).matrices(dragged)
        near, stations = pairs.beside(rail), len(every)
        flexibility = np.zeros((stations, *near.shape, patterns, patterns))
        rubbed = np.zeros((stations, *near.shape, dragged, dragged))
        number = self._numbers()
        for face, beside in enumerate(near):
            for place, other in enumerate(beside[beside >= 0]):
                between = self._between(number, self.normal[:, face], self.along[:, other])
                drag = self.toward[other] * first[:, other].swapaxes(1, 2)
                rubbed[:, face, place] = first[:, face] @ between @ drag
                if other < face:
                    continue
                between = self._between(number, self.normal[:, face], self.normal[:, other])
                found = every[:, face] @ between @ every[:, other].swapaxes(1, 2)
                flexibility[:, face, place] = found
                own = int(np.flatnonzero(near[other] == face)[0])
                flexibility[:, other, own] = found.swapaxes(1, 2)
        warm = np.einsum("sfan,sfnt,ft->tsfa", every, self.heated[self.normal], self.signs)
        return Tables(
            flexibility=flexibility,
            dragged=0.5 * (rubbed + pairs.transposed(rubbed, rail)),
            shape=every @ self.swung[self.normal],
            dragged_shape=self.toward[:, None, None] * (first @ self.swung[self.along]),
            warm=warm,
        )

    def _numbers(self) -> np.ndarray:
        """Number (l,l) of the block of two layers, -1 without one."""
        count = self.starts.size - 1
        found = np.full((count, count), -1)
        found[self.layers[:, 0], self.layers[:, 1]] = np.arange(len(self.layers))
        return found

    def _between(self, number: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """G (s,n,n) between the degrees of freedom ``rows`` (s,n) and ``columns`` (s,n), from the
        ``number`` (l,l) of each block. Raises ValueError for one that is missing."""
        one, other = (
            np.searchsorted(self.starts, own, side="right") - 1 for own in (rows, columns)
        )
        first, second = one[:, :, None], other[:, None, :]
        block = number[np.minimum(first, second), np.maximum(first, second)]
        if (block < 0).any():
            raise ValueError("nodal.layers: given too few, expected those of each pair of faces")
        row = (rows - self.starts[one])[:, :, None]
        column = (columns - self.starts[other])[:, None, :]
        turned = first > second
        return self.blocks[block, np.where(turned, column, row), np.where(turned, row, column)]
