"""Patterns of the part of a face that is over the wall, and those of the whole face.

Over an end of the rail, the compliance under a face is that of the part of it that has a wall, at
least half or three quarters of a pad. Between stations, values are interpolated in the patterns of
the part, where they change slowly. Kernels have those of the whole face. With the middle m and the half
length s of the part, in xi', a sum of patterns q is::

    u = q(t),    t = (xi' - m) / s,    du/dX = dq/dX - (m' + t s') / s dq/dt

In the patterns of the whole face, the coefficients change with high powers of m and s. A cubic between
stations does not follow them: at the end of a rail, in elements of 2 mm, forces by patterns of the
fourth degree would differ from statics by up to 15 % in place of 0.5 %.
"""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import patterns
from tipoff.mechanics.rail_compliance.patterns import FARTHEST

# Columns of ``Workspace.part``: m, s, and their derivatives (1/m) along the rail.
MIDDLE, HALF, MIDDLE_SLOPE, HALF_SLOPE, PART_SIZE = range(5)


@kernel
def take(compliance, face, place, changes):
    """Fill the part of a face while the first face is at X = ``place`` (m). ``changes`` is zero
    where the compliance does not change with the place, else one. Returns whether the face is not
    completely over the wall."""
    part, half = compliance.workspace.part[face], compliance.half[face, 0]
    middle, least = place + compliance.ahead[face], 2.0 * half * compliance.least[face]
    low = max(min(middle - half, compliance.end - least), compliance.start)
    high = min(max(middle + half, compliance.start + least), compliance.end)
    if middle - half >= compliance.start and middle + half <= compliance.end:
        part[MIDDLE], part[HALF], part[MIDDLE_SLOPE], part[HALF_SLOPE] = 0.0, 1.0, 0.0, 0.0
        return False
    rear, front = 1.0 if low == middle - half else 0.0, 1.0 if high == middle + half else 0.0
    part[MIDDLE], part[HALF] = (0.5 * (low + high) - middle) / half, 0.5 * (high - low) / half
    part[MIDDLE_SLOPE] = changes * (0.5 * (rear + front) - 1.0) / half
    part[HALF_SLOPE] = changes * 0.5 * (front - rear) / half
    if abs(part[MIDDLE]) > FARTHEST:
        part[MIDDLE], part[MIDDLE_SLOPE] = FARTHEST if part[MIDDLE] > 0.0 else -FARTHEST, 0.0
    return True


@kernel
def way_to_jump(compliance, face, place, speed):
    """Way (m) of the first face from X = ``place`` (m), in the direction of ``speed``, to the next place
    at which a face begins to leave the wall or its part becomes the shortest one, or the reverse:
    there the compliance changes with another slope. Infinite without one."""
    half, middle = compliance.half[face, 0], place + compliance.ahead[face]
    until, shortest = np.inf, 2.0 * half * (1.0 - compliance.least[face])
    for at in (compliance.end - half, compliance.start + half):
        beyond = shortest if at == compliance.end - half else -shortest
        for jump in (at, at + beyond):
            way = jump - middle if speed > 0.0 else middle - jump
            until = min(until, way) if way > 0.0 else until
    return until


@kernel
def to_whole(levels, part, values, first, stride):
    """Replace coefficients for the patterns of a ``part`` by those for the whole face; they are every
    ``stride``-th of the ``values`` from ``first`` on."""
    size = len(levels)
    for j in range(size):
        factor, last = 1.0, size - j - 1
        for i in range(last + 1):
            values[first + stride * patterns.number(i, j)] *= factor
            factor /= part[HALF]
        for k in range(last):
            for i in range(last - 1, k - 1, -1):
                above = values[first + stride * patterns.number(i + 1, j)]
                values[first + stride * patterns.number(i, j)] -= part[MIDDLE] * above


@kernel
def to_part(levels, part, force, out):
    """Fill ``out`` (p,) with the forces in the patterns of a ``part``, from ``force`` (p,) in those of
    the whole face: the transpose of ``to_whole``."""
    size = len(levels)
    for j in range(size):
        factor, last = 1.0, size - j - 1
        for i in range(last + 1):
            out[patterns.number(i, j)] = force[patterns.number(i, j)]
        for k in range(last - 1, -1, -1):
            for i in range(k, last):
                out[patterns.number(i + 1, j)] -= part[MIDDLE] * out[patterns.number(i, j)]
        for i in range(last + 1):
            out[patterns.number(i, j)] *= factor
            factor /= part[HALF]


@kernel
def add_drift(levels, part, values, slope, first, stride):
    """Add to ``slope`` the derivative along the rail of a sum of patterns at a place on the face, while
    the part with these patterns moves; coefficients as in ``to_whole``, for the part."""
    size = len(levels)
    for j in range(size):
        for i in range(size - j):
            n = first + stride * patterns.number(i, j)
            change = part[HALF_SLOPE] * i * values[n]
            if i < size - j - 1:
                above = values[first + stride * patterns.number(i + 1, j)]
                change += part[MIDDLE_SLOPE] * (i + 1) * above
            slope[n] -= change / part[HALF]


@kernel
def vector_to_whole(levels, part, values, slope):
    """Replace displacements (p,) and their ``slope`` (p,) along the rail by those in the patterns of
    the whole face."""
    add_drift(levels, part, values, slope, 0, 1)
    to_whole(levels, part, values, 0, 1)
    to_whole(levels, part, slope, 0, 1)


@kernel
def block_to_whole(levels, part, other, block, slope):
    """Replace the flexibility (p p,) of a face under the pressure of an ``other`` one, and its ``slope``
    along the rail, by those in the patterns of whole faces."""
    size = patterns.count(levels)
    for b in range(size):
        add_drift(levels, part, block, slope, b, size)
        add_drift(levels, other, block, slope, b * size, 1)
    for b in range(size):
        to_whole(levels, part, block, b, size)
        to_whole(levels, part, slope, b, size)
    for a in range(size):
        to_whole(levels, other, block, a * size, 1)
        to_whole(levels, other, slope, a * size, 1)
