"""Stiffness of an extruded mesh by columns: every section point has one column of nodes at equal
distances along X.

In a section of s points with n layers the stiffness couples a layer only to itself and its two
neighbours. Its 3x3 blocks between two section points are the same in every layer. The mirror
symmetry of a layer leaves 14 numbers::

    f(k) = D u(k) + L [u(k-1) + u(k+1)] + O [u(k+1) - u(k-1)]      D, L even and O odd under the mirror x -> -x
    f(0) = (D/2 + E) u(0) + (L + O) u(1),    f(n-1) = (D/2 - E) u(n-1) + (L - O) u(n-2)

The element matrix enters only through these numbers, so a better element costs nothing. Neighbours
that are mirror images share them, see ``folding``. Nodes are numbered point by point, with
contiguous layers. Each column is padded to whole vectors; the padding has no mass and no force.
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from tipoff.highfi.extruded.folding import Groups, fold
from tipoff.highfi.statics.assembly import Operator
from tipoff.kernels.memory import zeros
from tipoff.kernels.reference import by_reference

LANES = 16  # layers treated at once: two vectors of eight doubles
CHUNK = 1024  # nodes: large against a function call, small against the second-level cache
_SAME = 1e-9  # m: two places closer than this are the same
_ODD = 1e-9  # relative size of the blocks that the mirror symmetry forbids


@by_reference
class Columns(NamedTuple):
    """An extruded mesh of s columns in c chunks, and the stiffness between them."""

    groups: Groups  # neighbours of each column with D, L and O; members by their first node
    first: np.ndarray  # (s+1,) place in ``neighbour`` of the first one of each column
    neighbour: np.ndarray  # (q,) first node of each neighbour
    ends: np.ndarray  # (q,4) N/m, E xy xz yx zx of the end layers
    weights: np.ndarray  # (stride + LANES,) share of D in each layer
    layers: int  # nodes of a column
    stride: int  # its padded length
    chunks: np.ndarray  # (c+1,) first column of each chunk, the columns that are processed together
    lowest: np.ndarray  # (c,) lowest chunk that each chunk depends on
    highest: np.ndarray  # (c,) highest chunk that each chunk, or one before it, depends on


def is_even(points: np.ndarray) -> bool:
    """Whether nodes at ``points`` (n,3) m are those of an even extrusion along X."""
    return _grid(points) is not None


def _grid(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Places (s,2) in the section of an even extrusion, in units of ``_SAME``, and for each node the
    number (n,) of its place and of its layer; None if there is no even extrusion."""
    places, point = np.unique(np.round(points[:, 1:] / _SAME), axis=0, return_inverse=True)
    stations, layer = np.unique(np.round(points[:, 0] / _SAME), return_inverse=True)
    uneven = stations.size < 3 or np.ptp(np.diff(stations)) > 2.0
    if uneven or len(places) * stations.size != len(points):
        return None
    return places, point.reshape(-1), layer.reshape(-1)


def find(points: np.ndarray, operator: Operator) -> tuple[Columns, np.ndarray] | None:
    """Columns of a mesh (points (n,3) m) and the new number (n,) of each node; None if the mesh is
    not an even extrusion."""
    if operator.cells.shape[1] != 8 or (found := _grid(points)) is None:
        return None
    places, point, layer = found
    sections, layers = len(places), layer.max() + 1
    stride = -(-layers // LANES) * LANES
    blocks = _blocks(operator, point, layer, layers)
    if blocks is None:
        return None
    rank = _near_together(sections, list(blocks))
    pairs = sorted(blocks, key=lambda pair: (rank[pair[0]], rank[pair[1]]))
    own, other = rank[np.array(pairs)].T
    first = np.searchsorted(own, np.arange(sections + 1))
    numbers = np.array([_numbers(blocks[pair]) for pair in pairs])
    offsets = np.array([places[b] - places[a] for a, b in pairs]) * _SAME
    groups = fold(first, other * stride, offsets, numbers[:, :-4])
    chunks = _chunks(own, other, stride)
    chunk_of, starts = np.searchsorted(chunks, other, side="right") - 1, first[chunks[:-1]]
    lowest, highest = (
        np.minimum.reduceat(chunk_of, starts),
        np.maximum.accumulate(np.maximum.reduceat(chunk_of, starts)),
    )
    columns = Columns(
        groups=groups,
        first=first.astype(np.int64),
        neighbour=other.astype(np.int64) * stride,
        ends=numbers[:, -4:].copy(),
        weights=_weights(layers, stride),
        layers=layers,
        stride=stride,
        chunks=chunks,
        lowest=lowest,
        highest=highest,
    )
    return columns, rank[point] * stride + layer


def _weights(layers: int, stride: int) -> np.ndarray:
    """Part (stride + LANES,) of D in each layer: one half in the end layers, which have elements on
    one side only. Zeros beyond."""
    weights = zeros((stride + LANES,))
    weights[:layers] = 1.0
    weights[[0, layers - 1]] = 0.5
    return weights


def _chunks(own: np.ndarray, other: np.ndarray, stride: int) -> np.ndarray:
    """First column (c+1,) of chunks of about CHUNK nodes; no chunk holds columns of two rails."""
    sections = own[-1] + 1
    apart = (
        np.flatnonzero(
            np.maximum.accumulate(
                np.maximum.reduceat(other, np.searchsorted(own, np.arange(sections)))
            )[:-1]
            == np.arange(sections - 1)
        )
        + 1
    )
    bounds = [0, *apart, sections]
    parts = [
        np.linspace(a, b, max(1, round((b - a) * stride / CHUNK)) + 1).round()
        for a, b in itertools.pairwise(bounds)
    ]
    return np.unique(np.concatenate(parts)).astype(np.int64)


def _near_together(sections: int, pairs: list[tuple[int, int]]) -> np.ndarray:
    """New number (s,) of each section point: neighbours are close to each other, so that they share
    cache lines (Cuthill and McKee)."""
    rows, columns = np.array(pairs).T
    graph = csr_array((np.ones(len(pairs)), (rows, columns)), shape=(sections, sections))
    rank = np.empty(sections, dtype=np.int64)
    rank[reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(sections)
    return rank


def _blocks(operator, point, layer, layers) -> dict | None:
    """Blocks (2,2,3,3) over (own layer, other's layer) for each pair of section points; None if
    layers differ or lack symmetry."""
    lowest = layer[operator.cells].min(axis=1)
    per_layer = np.bincount(lowest, minlength=layers - 1)
    if (
        len(operator.cells) % (layers - 1)
        or np.ptp(per_layer[: layers - 1]) != 0
        or len(operator.stiffness) > per_layer[0]
    ):
        return None
    found = [
        _layer(operator, point, layer, np.flatnonzero(lowest == k))
        for k in sorted({0, (layers - 1) // 2, layers - 2})
    ]
    scale = max(np.abs(block).max() for block in found[0].values())
    for other in found[1:]:
        if other.keys() != found[0].keys() or any(
            np.abs(other[pair] - found[0][pair]).max() > _ODD * scale for pair in other
        ):
            return None
    return (
        found[0] if all(_forbidden(block) <= _ODD * scale for block in found[0].values()) else None
    )


def _layer(operator, point, layer, elements) -> dict[tuple[int, int], np.ndarray]:
    nodes = operator.cells[elements]
    points, upper = point[nodes], layer[nodes] - layer[nodes].min(axis=1, keepdims=True)
    shape = (len(nodes), 8, 8)
    own, other, own_upper, other_upper = (
        np.broadcast_to(part, shape)
        for part in (
            points[:, :, None],
            points[:, None, :],
            upper[:, :, None],
            upper[:, None, :],
        )
    )
    pairs, pair = np.unique(own * (point.max() + 1) + other, return_inverse=True)
    blocks = np.zeros((len(pairs), 2, 2, 3, 3))
    stiffness = operator.stiffness[operator.shape_class[elements]].reshape(-1, 8, 3, 8, 3)
    np.add.at(
        blocks, (pair.reshape(shape), own_upper, other_upper), stiffness.transpose(0, 1, 3, 2, 4)
    )
    numbers = zip(*(part.tolist() for part in np.divmod(pairs, point.max() + 1)))
    return dict(zip(numbers, blocks))


def _parts(block):
    """D, L, O, E of one pair."""
    return (
        block[0, 0] + block[1, 1],
        0.5 * (block[0, 1] + block[1, 0]),
        0.5 * (block[0, 1] - block[1, 0]),
        0.5 * (block[0, 0] - block[1, 1]),
    )


def _forbidden(block) -> float:
    own, sum_, difference, odd_own = _parts(block)
    mixed = [np.abs(even[0, 1:]).max() + np.abs(even[1:, 0]).max() for even in (own, sum_)]
    plain = [abs(odd[0, 0]) + np.abs(odd[1:, 1:]).max() for odd in (difference, odd_own)]
    return max(mixed + plain)


def _numbers(block) -> list[float]:
    """D, L and O in the order of ``folding.PLACES``, then E xy xz yx zx."""
    own, sum_, difference, odd_own = _parts(block)
    even = [even[i, j] for even in (own, sum_) for i, j in ((0, 0), (1, 1), (1, 2), (2, 1), (2, 2))]
    return even + [
        odd[i, j] for odd in (difference, odd_own) for i, j in ((0, 1), (0, 2), (1, 0), (2, 0))
    ]
