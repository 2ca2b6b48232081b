"""Thermal offset of warm rails: the displacement T of their walls without load
(``mechanics.rail_compliance``). Without temperatures ``warm`` has no stations and the functions do
nothing."""

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import parts, patterns


@kernel
def is_warm(warm):
    """Whether the rails have a temperature."""
    return warm.cubic.shape[0] > 0


@kernel
def evaluate(warm, face, station, s, changes):
    """Fill T and its slope along the rail under ``face``, ``s`` (m) from a station; ``changes`` is
    the derivative of ``s`` by the place."""
    if is_warm(warm):
        fill(warm, face, station, s, changes)


@kernel
def fill(warm, face, station, s, changes):
    """``evaluate`` on warm rails."""
    c = warm.cubic[station, face]
    for a in range(patterns.count(warm.levels)):
        warm.offset[face, a] = c[0, a] + s * (c[1, a] + s * (c[2, a] + s * c[3, a]))
        warm.slope[face, a] = changes * (c[1, a] + s * (2.0 * c[2, a] + s * 3.0 * c[3, a]))


@kernel
def to_whole(warm, face, part):
    """Replace T under ``face``, in the patterns of a ``part`` of it, by that of the whole face."""
    if is_warm(warm):
        parts.vector_to_whole(warm.levels, part, warm.offset[face], warm.slope[face])


@kernel
def offset(warm, face, pattern):
    """T (m) of one pattern."""
    value = 0.0
    if is_warm(warm):
        value = warm.offset[face, pattern]
    return value


@kernel
def axial_force(warm, face, force):
    """Force (N) along the rail of ``force`` (p,) N on a wall whose offset changes ahead."""
    total = 0.0
    if is_warm(warm):
        for a in range(patterns.count(warm.levels)):
            total += force[a] * warm.slope[face, a]
    return total


@kernel
def slope(warm, face, xi, eta):
    """Slope of the wall at a point of the face."""
    total = 0.0
    if is_warm(warm):
        total = patterns.value(warm.levels, warm.slope[face], xi, eta)
    return total
