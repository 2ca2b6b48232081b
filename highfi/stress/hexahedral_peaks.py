"""Displacement gradients at the corners of hexahedra, and their peaks (``stress.peak``), in one pass.

The gradient at a corner is that of ``elements.hexahedral_recovery``, bubbles included: differences
along the edges times the slopes of the element's class at the corner, plus the bubbles, whose
amplitudes are matrices of the class times the displacement.

The square of a gradient G (Frobenius norm) is at most the sum of the squared displacements u of the
corners relative to the first one, times the squared norm of the matrix between both. As strain^2 <=
G^2, rotation^2 <= G^2 / 2 and the square of the stress over the shear modulus is at most 6 strain^2,
an element cannot raise a peak while

    reach sum |u|^2 <= min(strain^2, 2 rotation^2, stress^2 / 6) of the peaks

and is skipped.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.elements import hexahedral_recovery
from tipoff.highfi.stress.peak import ROTATION, STRAIN, STRESS, measure, note
from tipoff.kernels.jit import entry, inlined, kernel
from tipoff.kernels.memory import aligned

CORNERS = 8
STEPS = 8.0  # cost of a scan of an element in steps: 180 against 25 ns, one thread each
_BATCH = 2048  # classes at once; bounds the memory of an unstructured mesh
_ROUNDING = 1e-9  # far above that of a gradient
_LANES = 16  # the nine amplitudes, padded to whole vectors
# Places in the workspace of one element; one flat array, so that the compiler sees that they do not
# overlap.
AT, ALONG, BUBBLES, GRADIENT, SQUARES, SIZE = 0, 24, 96, 112, 184, 208


class Recovery(NamedTuple):
    """Elements in c shape classes, and the matrices for gradients of their displacement."""

    cells: np.ndarray  # (e,8) numbers in the nodal arrays
    shape_class: np.ndarray  # (e,)
    amplitude: np.ndarray  # (c,24*16) of the bubbles, nine of 16 in use
    slope: np.ndarray  # (c,3*3*8) 1/m, of local coordinate i along j at each corner
    bubble: np.ndarray  # (c,3*3*8) 1/m, of bubble i along j at each corner
    reach: np.ndarray  # (c,) 1/m2, see above


def build(
    points: np.ndarray,
    hexes: np.ndarray,
    shape_class: np.ndarray,
    law: np.ndarray,
    number: np.ndarray,
) -> Recovery:
    """Recovery of a mesh, points (n,3) m and hexes (e,8), with the classes of its operator;
    ``number`` (n,) of each node in the nodal arrays."""
    _, representatives = np.unique(shape_class, return_index=True)
    corners = points[hexes[representatives]]
    parts = [
        _of_classes(corners[start : start + _BATCH], law)
        for start in range(0, len(corners), _BATCH)
    ]
    amplitude, slope, bubble, reach = (aligned(np.concatenate(part)) for part in zip(*parts))
    return Recovery(
        cells=number[hexes].astype(np.uint32),
        shape_class=shape_class,
        amplitude=amplitude,
        slope=slope,
        bubble=bubble,
        reach=reach,
    )


def _of_classes(corners: np.ndarray, law: np.ndarray) -> tuple[np.ndarray, ...]:
    amplitude = np.zeros((len(corners), 24, _LANES))
    by_bubble = hexahedral_recovery.amplitudes(corners, law).reshape(-1, 3, 3, 24)
    amplitude[:, :, :9] = by_bubble.transpose(0, 3, 2, 1).reshape(-1, 24, 9)
    slope, bubble = hexahedral_recovery.corner_gradients(corners)
    return (
        amplitude.reshape(-1, 24 * _LANES),
        np.moveaxis(slope, 1, 3).reshape(-1, 72),
        np.moveaxis(bubble, 1, 3).reshape(-1, 72),
        _reach(corners, by_bubble, bubble),
    )


def _reach(corners: np.ndarray, by_bubble: np.ndarray, bubble: np.ndarray) -> np.ndarray:
    """Bound (c,) 1/m2 of the squared spectral norm of the matrices from the corners' displacement to the gradient at a
    corner; amplitudes ``by_bubble`` (c,3,3,24) and gradients of each ``bubble`` (c,8,3,3)."""
    local = np.tile(hexahedral_recovery.NODES, (len(corners), 1))
    nodal, _ = hexahedral_recovery.gradients(np.repeat(corners, CORNERS, axis=0), local)
    matrix = np.einsum(
        "cpbj,cbiam->cpijam", bubble, by_bubble.reshape(-1, 3, 3, CORNERS, 3), optimize=True
    )
    for i in range(3):
        matrix[:, :, i, :, :, i] += nodal.reshape(-1, CORNERS, CORNERS, 3).transpose(0, 1, 3, 2)
    matrix = matrix[..., 1:, :].reshape(-1, CORNERS, 9, 3 * (CORNERS - 1))
    # the largest eigenvalue of B is at most the root of the Frobenius norm of B B
    square = matrix @ np.swapaxes(matrix, 2, 3)
    largest = np.sqrt(np.linalg.norm(square @ square, axis=(2, 3)))
    return (1.0 + _ROUNDING) * largest.max(axis=1)


@entry
def find(displacement, recovery, peak, space, first, last):
    """Raise ``peak`` to the values of elements ``first`` to ``last`` under displacement (n,3) m;
    ``space`` (SIZE,) is workspace."""
    u, least = displacement.T, _least(peak)
    for e in range(first, last):
        if recovery.reach[recovery.shape_class[e]] * _square(u, recovery.cells[e]) <= least:
            continue
        _gradients(u, recovery, space, e)
        if measure(space, peak.square, GRADIENT, SQUARES, CORNERS) > 0:
            note(space, peak, e, SQUARES, CORNERS)
            least = _least(peak)


@inlined
def _least(peak):
    """Square of a gradient up to which it raises no peak."""
    return min(peak.square[STRAIN], 2.0 * peak.square[ROTATION], peak.square[STRESS] / 6.0)


@inlined
def _square(u, nodes):
    """Sum of the squared displacements (m2) of the corners relative to the first one."""
    total = 0.0
    for i in range(3):
        first = u[i, nodes[0]]
        for k in range(1, 8):
            away = u[i, nodes[k]] - first
            total += away * away
    return total


@kernel
def gradients(displacement, recovery, space, first, last, out):
    """Fill ``out`` (last - first, 72) with displacement gradients of elements ``first`` to
    ``last``: component, axis, corner."""
    u = displacement.T
    for e in range(first, last):
        _gradients(u, recovery, space, e)
        for j in range(72):
            out[e - first, j] = space[GRADIENT + j]


@inlined
def _gradients(u, recovery, space, e):
    """GRADIENT: displacement gradient at each corner of element ``e``."""
    c = recovery.shape_class[e]
    for i in range(3):
        _gather(u[i], recovery.cells[e], space, i)
    _bubbles(recovery.amplitude[c], space)
    for i in range(3):
        _gradient(recovery.slope[c], recovery.bubble[c], space, i)


@inlined
def _gather(u, nodes, space, i):
    """AT + 8 i: displacement along i of the corners, relative to the first one; ALONG + 24 i: its
    differences along the edges of each local axis, at each corner."""
    first = u[nodes[0]]
    b, c, d, e = u[nodes[1]] - first, u[nodes[2]] - first, u[nodes[3]] - first, u[nodes[4]] - first
    f, g, h = u[nodes[5]] - first, u[nodes[6]] - first, u[nodes[7]] - first
    _row(space, AT + 8 * i, (0.0, b, c, d, e, f, g, h))
    _row(space, ALONG + 24 * i, (b, b, c - d, c - d, f - e, f - e, g - h, g - h))
    _row(space, ALONG + 24 * i + 8, (d, c - b, c - b, d, h - e, g - f, g - f, h - e))
    _row(space, ALONG + 24 * i + 16, (e, f - b, g - c, h - d, e, f - b, g - c, h - d))


@inlined
def _row(space, n, values):
    """Write eight ``values`` from place ``n``."""
    for k in range(8):
        space[n + k] = values[k]


@inlined
def _bubbles(amplitude, space):
    """BUBBLES: amplitudes of the bubbles, component * 3 + bubble."""
    for j in range(_LANES):
        space[BUBBLES + j] = 0.0
    for k in range(1, 8):
        x, y, z = space[AT + k], space[AT + 8 + k], space[AT + 16 + k]
        n = 3 * _LANES * k
        for j in range(_LANES):
            space[BUBBLES + j] += (
                amplitude[n + j] * x
                + amplitude[n + _LANES + j] * y
                + amplitude[n + 2 * _LANES + j] * z
            )


@inlined
def _gradient(slope, bubble, space, i):
    """GRADIENT + 24 i: slope of displacement i along each axis, at each corner."""
    x, y, z = space[BUBBLES + 3 * i], space[BUBBLES + 3 * i + 1], space[BUBBLES + 3 * i + 2]
    for j in range(24):
        k = ALONG + 24 * i + (j & 7)
        space[GRADIENT + 24 * i + j] = (
            space[k] * slope[j] + space[k + 8] * slope[24 + j] + space[k + 16] * slope[48 + j]
        ) + (x * bubble[j] + y * bubble[24 + j] + z * bubble[48 + j])
