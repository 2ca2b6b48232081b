"""An extruded mesh as pencils: every section point carries one column of nodes at equal distances along X.

In a section of s points with n layers the stiffness couples a layer to itself and its two neighbours only. Its 3x3 blocks between
two section points are the same in every layer, and the mirror symmetry of a layer leaves 14 numbers of them::

    f(k) = D u(k) + L [u(k-1) + u(k+1)] + O [u(k+1) - u(k-1)]      D, L even and O odd under the mirror x -> -x
    f(0) = (D/2 + E) u(0) + (L + O) u(1),    f(n-1) = (D/2 - E) u(n-1) + (L - O) u(n-2)

The element matrix enters through these numbers alone, so a better element costs nothing. Nodes are numbered point by point with the
layers contiguous, each pencil padded to whole vectors; the padding has no mass and no force.
"""

from typing import NamedTuple

import numpy as np

from highfi.assembly import Operator

LANES = 16  # layers treated at once: two vectors of eight doubles
COEFFICIENTS = 18
_SAME = 1e-9  # m: two places closer than this are the same
_ODD = 1e-9  # relative size of the blocks that the mirror symmetry forbids


class Pencils(NamedTuple):
    """first (s+1,), neighbour (q,) number of the neighbour's first node; coefficients (q, COEFFICIENTS) N/m in the order D xx yy yz
    zy zz, L the same, O xy xz yx zx, E the same; layers n and stride, the padded length of a pencil."""

    first: np.ndarray
    neighbour: np.ndarray
    coefficients: np.ndarray
    layers: int
    stride: int


def find(points: np.ndarray, operator: Operator) -> tuple[Pencils, np.ndarray] | None:
    """Pencils of a mesh (points (n,3) m) and the new number (n,) of each node, or None where it is not an even extrusion."""
    _, point = np.unique(np.round(points[:, 1:] / _SAME), axis=0, return_inverse=True)
    stations, layer = np.unique(np.round(points[:, 0] / _SAME), return_inverse=True)
    point, layer = point.reshape(-1), layer.reshape(-1)
    sections, layers = point.max() + 1, stations.size
    if layers < 3 or np.ptp(np.diff(stations)) > 2.0 or sections * layers != len(points):
        return None
    stride = -(-layers // LANES) * LANES
    blocks = _blocks(operator, point, layer, layers)
    if blocks is None:
        return None
    pairs = sorted(blocks)
    first = np.searchsorted([a for a, _ in pairs], np.arange(sections + 1))
    coefficients = np.array([_numbers(blocks[pair]) for pair in pairs])
    neighbour = np.array([b for _, b in pairs], dtype=np.int64) * stride
    return Pencils(first.astype(np.int64), neighbour, coefficients, layers, stride), point * stride + layer


def _blocks(operator, point, layer, layers) -> dict | None:
    """Blocks (2,2,3,3) over (own layer, other's layer) for each pair of section points; None if layers differ or lack symmetry."""
    lowest = layer[operator.hexes].min(axis=1)
    per_layer = np.bincount(lowest, minlength=layers - 1)
    if len(operator.hexes) % (layers - 1) or np.ptp(per_layer[:layers - 1]) != 0 or len(operator.stiffness) > per_layer[0]:
        return None
    found = [_layer(operator, point, layer, np.flatnonzero(lowest == k)) for k in sorted({0, (layers - 1) // 2, layers - 2})]
    scale = max(np.abs(block).max() for block in found[0].values())
    for other in found[1:]:
        if other.keys() != found[0].keys() or any(np.abs(other[pair] - found[0][pair]).max() > _ODD * scale for pair in other):
            return None
    return found[0] if all(_forbidden(block) <= _ODD * scale for block in found[0].values()) else None


def _layer(operator, point, layer, elements) -> dict:
    blocks = {}
    for element in elements:
        nodes = operator.hexes[element]
        stiffness = operator.stiffness[operator.shape_class[element]].reshape(8, 3, 8, 3)
        upper = layer[nodes] - layer[nodes].min()
        for i in range(8):
            for j in range(8):
                block = blocks.setdefault((int(point[nodes[i]]), int(point[nodes[j]])), np.zeros((2, 2, 3, 3)))
                block[upper[i], upper[j]] += stiffness[i, :, j, :]
    return blocks


def _parts(block):
    """D, L, O, E of one pair."""
    return (block[0, 0] + block[1, 1], 0.5 * (block[0, 1] + block[1, 0]), 0.5 * (block[0, 1] - block[1, 0]),
            0.5 * (block[0, 0] - block[1, 1]))


def _forbidden(block) -> float:
    d, l, o, e = _parts(block)
    mixed = [np.abs(even[0, 1:]).max() + np.abs(even[1:, 0]).max() for even in (d, l)]
    plain = [abs(odd[0, 0]) + np.abs(odd[1:, 1:]).max() for odd in (o, e)]
    return max(mixed + plain)


def _numbers(block) -> list[float]:
    d, l, o, e = _parts(block)
    even = [even[i, j] for even in (d, l) for i, j in ((0, 0), (1, 1), (1, 2), (2, 1), (2, 2))]
    return even + [odd[i, j] for odd in (o, e) for i, j in ((0, 1), (0, 2), (1, 0), (2, 0))]
