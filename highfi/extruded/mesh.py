"""Stiffness of an extruded mesh by columns: every section point has one column of nodes along X.

In a section of s points with n planes of nodes the stiffness couples a plane only to itself and its
two neighbours. A layer, the elements between two planes, is its own mirror image. Its 3x3 blocks
between two section points are D/2 + E and D/2 - E in its lower and its upper plane, L + O and L - O
between them. D and L are even under the mirror x -> -x, O and E are odd, so 18 of these numbers are
not zero. If all layers have the same length::

    f(k) = D u(k) + L [u(k-1) + u(k+1)] + O [u(k+1) - u(k-1)]
    f(0) = (D/2 + E) u(0) + (L + O) u(1),    f(n-1) = (D/2 - E) u(n-1) + (L - O) u(n-2)

In a layer of length h the gradients along X have the factor 1/h, and its volume has the factor h. The
bubbles of an element along X are odd about its middle, and those across are even, so that neither
couples with the other in its elimination. So, with blocks A, B and C that depend on the section alone,

    D/2 = h A + C / h,    L = h B - C / h,    O and E are the same for any length

D/2 + L = h S is then proportional to the length, and D/2 = v Q + w R, where Q and R are the D/2 of the
shortest and of the longest layer, and the weights v and w give h and 1/h of the lengths of these two.
Q, R and S are exact for any number of lengths. Contributions of E cancel, but for the ends.

The element matrix enters only through these numbers, so a better element costs nothing. Neighbours
that are mirror images share them, see ``folding``. Nodes are numbered point by point, with
contiguous layers. Each column is padded to whole vectors; the padding has no mass and no force.
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from tipoff.highfi.extruded.folding import EQUAL, EVEN_PLACES, ODD_PLACES, UNEQUAL, Groups, fold
from tipoff.highfi.extruded.vectors import WIDTH
from tipoff.highfi.statics.assembly import Operator
from tipoff.kernels.memory import zeros
from tipoff.kernels.reference import by_reference

LANES = 16  # layers treated at once: two vectors of eight doubles
CHUNK = 1024  # nodes: large against a function call, small against the second-level cache
_SAME = 1e-9  # m: two places closer than this are the same
_ODD = 1e-9  # relative size of a block that the mirror symmetry or the length of its layer forbids


@by_reference
class Columns(NamedTuple):
    """An extruded mesh of s columns in c chunks, and the stiffness between them."""

    # neighbours of each column with D, L and O, or Q, R, S and O; members by their first node
    groups: Groups
    first: np.ndarray  # (s+1,) place in ``neighbour`` of the first one of each column
    neighbour: np.ndarray  # (q,) first node of each neighbour
    ends: np.ndarray  # (q,4) N/m, E xy xz yx zx of the end layers
    # (stride + LANES,) share of D of each node; or three rows of as many numbers for v, w and h (m) of
    # the layer above each node, after WIDTH zeros
    weights: np.ndarray
    layers: int  # nodes of a column
    stride: int  # its padded length
    chunks: np.ndarray  # (c+1,) first column of each chunk, the columns that are processed together
    lowest: np.ndarray  # (c,) lowest chunk that each chunk depends on
    highest: np.ndarray  # (c,) highest chunk that each chunk, or one before it, depends on


class _Grid(NamedTuple):
    """Nodes of an extrusion along X."""

    places: np.ndarray  # (s,2) in the section, in units of ``_SAME``
    point: np.ndarray  # (n,) number of the place of each node
    plane: np.ndarray  # (n,) number of its plane
    lengths: np.ndarray  # (planes - 1,) m, of the layers

    @property
    def is_equal(self) -> bool:
        """Whether all layers have the same length."""
        return bool(np.ptp(self.lengths) <= 2.0 * _SAME)


def is_extruded(points: np.ndarray) -> bool:
    """Whether nodes at ``points`` (n,3) m are those of an extrusion along X."""
    return _grid(points) is not None


def _grid(points: np.ndarray) -> _Grid | None:
    """The nodes at ``points`` (n,3) m; None if they are no extrusion of two layers or more."""
    places, point = np.unique(np.round(points[:, 1:] / _SAME), axis=0, return_inverse=True)
    _, first, plane = np.unique(
        np.round(points[:, 0] / _SAME), return_index=True, return_inverse=True
    )
    if first.size < 3 or len(places) * first.size != len(points):
        return None
    return _Grid(places, point.reshape(-1), plane.reshape(-1), np.diff(points[first, 0]))


def find(points: np.ndarray, operator: Operator) -> tuple[Columns, np.ndarray] | None:
    """Columns of a mesh (points (n,3) m) and the new number (n,) of each node; None if the mesh is
    not an extrusion."""
    if operator.cells.shape[1] != 8 or (grid := _grid(points)) is None:
        return None
    stiffness = _stiffness(operator, grid)
    if stiffness is None:
        return None
    sections, planes = len(grid.places), grid.lengths.size + 1
    stride = -(-planes // LANES) * LANES
    rank = _near_together(sections, stiffness.pairs)
    order = np.lexsort(rank[stiffness.pairs].T[::-1])
    pairs = stiffness.pairs[order]
    own, other = rank[pairs].T
    first = np.searchsorted(own, np.arange(sections + 1))
    offsets = (grid.places[pairs[:, 1]] - grid.places[pairs[:, 0]]) * _SAME
    layout = EQUAL if grid.is_equal else UNEQUAL
    groups = fold(layout, first, other * stride, offsets, stiffness.numbers[order])
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
        ends=stiffness.ends[order],
        weights=_shares(planes, stride)
        if grid.is_equal
        else _weights(grid.lengths, stiffness.lengths, stride),
        layers=planes,
        stride=stride,
        chunks=chunks,
        lowest=lowest,
        highest=highest,
    )
    return columns, rank[grid.point] * stride + grid.plane


def _shares(planes: int, stride: int) -> np.ndarray:
    """Part (stride + LANES,) of D at each node: one half in the end planes, which have elements on
    one side only. Zeros beyond."""
    weights = zeros((stride + LANES,))
    weights[:planes] = 1.0
    weights[[0, planes - 1]] = 0.5
    return weights


def _weights(lengths: np.ndarray, ends: tuple[float, float], stride: int) -> np.ndarray:
    """``Columns.weights`` of layers with these ``lengths`` (m), the ``ends`` (m) of their range."""
    rows = zeros((3, stride + LANES))
    rows[:, WIDTH : WIDTH + lengths.size] = *_of_ends(lengths, ends), lengths
    return rows.reshape(-1)


def _of_ends(lengths: np.ndarray, ends: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Weights (k,) of the ``ends`` (m) of the range of ``lengths`` (k,) m: they give both the length
    and its inverse of each. Their sum is one to rounding, however short the range is."""
    short, long = ends

    def apart(one, other):
        return (one - other) * (one + other) / (one * other)  # one / other - other / one

    return apart(long, lengths) / apart(long, short), apart(lengths, short) / apart(long, short)


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


def _near_together(sections: int, pairs: np.ndarray) -> np.ndarray:
    """New number (s,) of each section point: neighbours are close to each other, so that they share
    cache lines (Cuthill and McKee)."""
    rows, columns = pairs.T
    graph = csr_array((np.ones(len(pairs)), (rows, columns)), shape=(sections, sections))
    rank = np.empty(sections, dtype=np.int64)
    rank[reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(sections)
    return rank


class _Stiffness(NamedTuple):
    """Stiffness between p pairs of section points."""

    pairs: np.ndarray  # (p,2) their numbers
    numbers: np.ndarray  # (p,k) of the layout
    ends: np.ndarray  # (p,4) N/m, E xy xz yx zx
    lengths: tuple[float, float]  # m, of the shortest and the longest layer


class _Blocks(NamedTuple):
    """The blocks (p,3,3) N/m of p pairs of section points in one layer."""

    pairs: np.ndarray  # (p,2) numbers of the points
    half: np.ndarray  # D/2
    between: np.ndarray  # L
    odd: np.ndarray  # O
    ends: np.ndarray  # E


def _stiffness(operator: Operator, grid: _Grid) -> _Stiffness | None:
    """Numbers of all pairs; None if layers lack symmetry or differ by more than their lengths."""
    layers = _different_layers(operator, grid)
    if layers is None:
        return None
    found = [_blocks(operator, grid, elements) for elements in layers.values()]
    lengths = grid.lengths[list(layers)]
    short, long = (
        (found[0], found[0])
        if grid.is_equal
        else (found[lengths.argmin()], found[lengths.argmax()])
    )
    ends = float(lengths.min()), float(lengths.max())
    per_length = (long.half + long.between) / ends[1]
    limit = _ODD * max(np.abs(each).max() for one in (short, long) for each in one[1:])
    for layer, blocks in zip(lengths, found):
        expected = short
        if not grid.is_equal:
            v, w = _of_ends(layer, ends)
            half = v * short.half + w * long.half
            expected = long._replace(half=half, between=layer * per_length - half)
        if not np.array_equal(blocks.pairs, expected.pairs) or any(
            np.abs(one - other).max() > limit for one, other in zip(blocks[1:], expected[1:])
        ):
            return None
    if max(map(_forbidden, (short, long))) > limit:
        return None
    even = [2.0 * short.half, short.between]
    if not grid.is_equal:
        even = [short.half, long.half, per_length]
    numbers = [_numbers(block, EVEN_PLACES) for block in even]
    return _Stiffness(
        pairs=short.pairs,
        numbers=np.concatenate([*numbers, _numbers(short.odd, ODD_PLACES)], axis=1),
        ends=_numbers(short.ends, ODD_PLACES),
        lengths=ends,
    )


def _different_layers(operator: Operator, grid: _Grid) -> dict[int, np.ndarray] | None:
    """Elements of each layer that is no translation of one before it; None if elements are no
    layers of the same quadrilaterals."""
    layers, planes = grid.lengths.size, grid.plane[operator.cells]
    lowest, points = planes.min(axis=1), np.sort(grid.point[operator.cells], axis=1)
    order = np.lexsort((*points.T, lowest))
    if (
        order.size % layers
        or (planes.max(axis=1) != lowest + 1).any()
        or (points[:, ::2] != points[:, 1::2]).any()
    ):
        return None
    rows = order.reshape(layers, -1)
    if (lowest[rows] != np.arange(layers)[:, None]).any() or (
        points[rows] != points[rows[0]]
    ).any():
        return None
    _, first = np.unique(operator.shape_class[rows], axis=0, return_index=True)
    return {layer: np.sort(rows[layer]) for layer in np.sort(first).tolist()}


def _blocks(operator: Operator, grid: _Grid, elements: np.ndarray) -> _Blocks:
    """The blocks of the layer with these ``elements``."""
    nodes, sections = operator.cells[elements], len(grid.places)
    points, planes = grid.point[nodes], grid.plane[nodes]
    upper, shape = planes - planes.min(axis=1, keepdims=True), (len(nodes), 8, 8)
    own, other, own_upper, other_upper = (
        np.broadcast_to(part, shape)
        for part in (
            points[:, :, None],
            points[:, None, :],
            upper[:, :, None],
            upper[:, None, :],
        )
    )
    pairs, pair = np.unique(own * sections + other, return_inverse=True)
    block = np.zeros((len(pairs), 2, 2, 3, 3))
    stiffness = operator.stiffness[operator.shape_class[elements]].reshape(-1, 8, 3, 8, 3)
    np.add.at(
        block, (pair.reshape(shape), own_upper, other_upper), stiffness.transpose(0, 1, 3, 2, 4)
    )
    return _Blocks(
        pairs=np.stack(np.divmod(pairs, sections), axis=1),
        half=0.5 * (block[:, 0, 0] + block[:, 1, 1]),
        between=0.5 * (block[:, 0, 1] + block[:, 1, 0]),
        odd=0.5 * (block[:, 0, 1] - block[:, 1, 0]),
        ends=0.5 * (block[:, 0, 0] - block[:, 1, 1]),
    )


def _forbidden(blocks: _Blocks) -> float:
    """Largest number (N/m) that the mirror symmetry forbids."""
    none = [_numbers(each, ODD_PLACES) for each in (blocks.half, blocks.between)]
    none += [_numbers(each, EVEN_PLACES) for each in (blocks.odd, blocks.ends)]
    return max(np.abs(each).max() for each in none)


def _numbers(block: np.ndarray, places: tuple[tuple[int, int], ...]) -> np.ndarray:
    """The numbers (p,k) of blocks (p,3,3) at ``places``."""
    rows, columns = map(list, zip(*places))
    return block[:, rows, columns]
