"""Displacement gradients at the corners of hexahedra, and the worst of them (``highfi.stress.peak``),
found in one pass.

A corner's gradient is that of ``highfi.elements.hexahedral_recovery``, bubbles included: differences along the edges,
turned by what the element's class has at that corner, and the amplitudes of the bubbles, which are
products of its class with the displacement.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.elements import hexahedral_recovery
from tipoff.highfi.stress.peak import measure, note
from tipoff.kernels.jit import inlined, kernel
from tipoff.kernels.memory import aligned

CORNERS = 8
STEPS = 8.0  # that a look at an element costs: 180 against 25 ns, one thread each
_BATCH = 2048  # classes at once; bounds the memory of an unstructured mesh
_LANES = 16  # the nine amplitudes, padded to whole vectors
# Places in the room for one element; flat arrays, because the compiler must see that they lie
# apart.
AT, ALONG, BUBBLES, GRADIENT, SQUARES, SIZE = 0, 24, 96, 112, 184, 208


class Recovery(NamedTuple):
    """Constant: cells (e,8) numbers in the nodal arrays; shape_class (e,); for each class amplitude
    (c,24*16) of the bubbles, nine of 16 in use, slope and bubble (c,3*3*8) 1/m: of local coordinate
    and of bubble i along j at each corner."""

    cells: np.ndarray
    shape_class: np.ndarray
    amplitude: np.ndarray
    slope: np.ndarray
    bubble: np.ndarray


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
    amplitude, slope, bubble = (aligned(np.concatenate(part)) for part in zip(*parts))
    return Recovery(number[hexes].astype(np.uint32), shape_class, amplitude, slope, bubble)


def _of_classes(corners: np.ndarray, law: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    amplitude = np.zeros((len(corners), 24, _LANES))
    by_component = (
        hexahedral_recovery.amplitudes(corners, law).reshape(-1, 3, 3, 24).transpose(0, 3, 2, 1)
    )
    amplitude[:, :, :9] = by_component.reshape(-1, 24, 9)
    slope, bubble = (
        np.moveaxis(part, 1, 3).reshape(-1, 72)
        for part in hexahedral_recovery.corner_gradients(corners)
    )
    return amplitude.reshape(-1, 24 * _LANES), slope, bubble


@kernel
def find(displacement, recovery, worst, room, first, last):
    """Raise ``worst`` to what elements ``first`` to ``last`` have under displacement (n,3) m;
    ``room`` (SIZE,) for one of them."""
    u = displacement.T
    for e in range(first, last):
        _gradients(u, recovery, room, e)
        if measure(room, worst.square, GRADIENT, SQUARES, CORNERS) > 0:
            note(room, worst, e, SQUARES, CORNERS)


@kernel
def gradients(displacement, recovery, room, first, last, out):
    """Fill ``out`` (last - first, 72) with displacement gradients of elements ``first`` to
    ``last``: component, axis, corner."""
    u = displacement.T
    for e in range(first, last):
        _gradients(u, recovery, room, e)
        for j in range(72):
            out[e - first, j] = room[GRADIENT + j]


@inlined
def _gradients(u, recovery, room, e):
    """GRADIENT: displacement gradient at each corner of element ``e``."""
    c = recovery.shape_class[e]
    for i in range(3):
        _gather(u[i], recovery.cells[e], room, i)
    _bubbles(recovery.amplitude[c], room)
    for i in range(3):
        _gradient(recovery.slope[c], recovery.bubble[c], room, i)


@inlined
def _gather(u, nodes, room, i):
    """AT + 8 i: displacement along i of the corners, from that of the first one; ALONG + 24 i: its
    differences along the edges of each local axis, at each corner."""
    first = u[nodes[0]]
    b, c, d, e = u[nodes[1]] - first, u[nodes[2]] - first, u[nodes[3]] - first, u[nodes[4]] - first
    f, g, h = u[nodes[5]] - first, u[nodes[6]] - first, u[nodes[7]] - first
    _row(room, AT + 8 * i, 0.0, b, c, d, e, f, g, h)
    _row(room, ALONG + 24 * i, b, b, c - d, c - d, f - e, f - e, g - h, g - h)
    _row(room, ALONG + 24 * i + 8, d, c - b, c - b, d, h - e, g - f, g - f, h - e)
    _row(room, ALONG + 24 * i + 16, e, f - b, g - c, h - d, e, f - b, g - c, h - d)


@inlined
def _row(room, n, a, b, c, d, e, f, g, h):
    room[n], room[n + 1], room[n + 2], room[n + 3] = a, b, c, d
    room[n + 4], room[n + 5], room[n + 6], room[n + 7] = e, f, g, h


@inlined
def _bubbles(amplitude, room):
    """BUBBLES: amplitudes of the bubbles, component * 3 + bubble."""
    for j in range(_LANES):
        room[BUBBLES + j] = 0.0
    for k in range(1, 8):
        x, y, z = room[AT + k], room[AT + 8 + k], room[AT + 16 + k]
        n = 3 * _LANES * k
        for j in range(_LANES):
            room[BUBBLES + j] += (
                amplitude[n + j] * x
                + amplitude[n + _LANES + j] * y
                + amplitude[n + 2 * _LANES + j] * z
            )


@inlined
def _gradient(slope, bubble, room, i):
    """GRADIENT + 24 i: slope of displacement i along each axis, at each corner."""
    x, y, z = room[BUBBLES + 3 * i], room[BUBBLES + 3 * i + 1], room[BUBBLES + 3 * i + 2]
    for j in range(24):
        k = ALONG + 24 * i + (j & 7)
        room[GRADIENT + 24 * i + j] = (
            room[k] * slope[j] + room[k + 8] * slope[24 + j] + room[k + 16] * slope[48 + j]
        ) + (x * bubble[j] + y * bubble[24 + j] + z * bubble[48 + j])
