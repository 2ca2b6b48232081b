"""Fillet in the inner corner of an L section: nodes of a grid are moved so that the inner walls run
into an arc.

Depths (a, b), measured inwards from the outer corner, become (a, b) + w m for a >= b, with the
thickness t, the radius r and u = (a - t) / r, held between 0 and 1::

    m = r (1 - u - q sin f,  1 - q cos f),  f = (1 - u) pi / 4    from the sharp wall to the fillet
    w = (min(a, t) b / t^2)^p                                     1 on the wall, 0 on the back

and likewise with the axes exchanged. Points on the back and beyond the fillet stay, so mounts and
walls keep their borders. The wall becomes a polygon around the centre of the fillet. q is 1 at its
ends; between them it is a little more, so that the area of metal is that of the arc,
(1 - pi / 4) r^2. At the middle of the fillet three elements share the half circle of metal. With p,
the lines that meet there are 15 degrees off the grid, so in the limit of small elements each has
60 degrees.
"""

import math

import numpy as np

LARGEST = 1.25  # of the thickness; with a larger fillet p < 1, and elements at the back degenerate
_LINE = math.tan(math.radians(15.0))


def rounded(depths: np.ndarray, thickness: float, radius: float) -> np.ndarray:
    """Points (n,2) m of a section with a fillet of ``radius`` (m), from those ``depths`` (n,2) m of
    the sharp one; ``thickness`` (m) of the legs."""
    long, short = depths.max(axis=1), depths.min(axis=1)
    # rounded, because the end of the fillet must stay on the wall
    along = np.clip(np.round((long - thickness) / radius, 9), 0.0, 1.0)
    angle = 0.25 * np.pi * (1.0 - along)
    size = np.where(angle > 0.0, _of_equal_area(np.unique(angle)), 1.0)
    move = radius * np.stack(
        [1.0 - along - size * np.sin(angle), 1.0 - size * np.cos(angle)], axis=1
    )
    share = np.minimum(long, thickness) * short / thickness**2
    moved = share[:, None] ** _power(thickness, radius) * move
    swapped = depths[:, 0] < depths[:, 1]
    moved[swapped] = moved[swapped, ::-1]
    return depths + moved


def _of_equal_area(angles: np.ndarray) -> float:
    """q, from the sum of the triangles between the centre and half of the polygon: its first corner,
    at ``angles`` (k,) of zero, is on the arc, and the others are q times as far from the centre."""
    heights = 0.5 * np.sin(np.diff(angles))
    first, others = heights[0], heights[1:].sum()
    # others q^2 + first q = pi / 8, the root without a division by zero
    return 0.25 * np.pi / (first + math.sqrt(first**2 + 0.5 * np.pi * others))


def _power(thickness: float, radius: float) -> float:
    """p, from p d / (t + p d) = tan 15 degrees with the depth d of the arc behind the corner along
    each axis."""
    depth = radius * (1.0 - math.sqrt(0.5))
    return max(1.0, thickness / depth * _LINE / (1.0 - _LINE))
