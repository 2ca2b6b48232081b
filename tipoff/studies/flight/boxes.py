"""Distance of a rotating box from other boxes: the largest separation on the 15 axes that can separate
two boxes (Gottschalk, Lin and Manocha, SIGGRAPH 1996), or the distance over all face axes of one box that
separate them.

Below zero it is the exact depth of overlap. Above zero it is exact if the nearest points are a corner and
a face or two edges, or if the boxes are parallel. Otherwise it is below the distance, so a positive value
always means that the boxes are apart.
"""

from collections.abc import Callable

import numpy as np

_AGAIN = 16  # instants around the best instant of the round before
_PARALLEL = 1e-9  # sine below which two edges give no axis; axes of the faces replace it


def separation(
    turn: np.ndarray, centre: np.ndarray, half: np.ndarray, other: np.ndarray
) -> np.ndarray:
    """Separation (...) m of boxes of half sizes ``half`` (...,3), whose axes are the columns of
    ``turn`` (...,3,3) and whose centre lies at ``centre`` (...,3), from boxes of half sizes
    ``other`` (...,3) about the origin and along the axes."""
    size = abs(turn)
    found = np.maximum(
        _faces(abs(centre) - other - np.einsum("...ij,...j->...i", size, half)),
        _faces(
            abs(np.einsum("...i,...ij->...j", centre, turn))
            - half
            - np.einsum("...ij,...i->...j", size, other)
        ),
    )
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            # sine between edge i of one and edge m of the other
            long = np.hypot(turn[..., j, m], turn[..., k, m])
            apart = (
                abs(centre[..., k] * turn[..., j, m] - centre[..., j] * turn[..., k, m])
                - other[..., j] * size[..., k, m]
                - other[..., k] * size[..., j, m]
                - half[..., p] * size[..., i, q]
                - half[..., q] * size[..., i, p]
            )
            found = np.where(
                long > _PARALLEL, np.maximum(found, apart / np.maximum(long, _PARALLEL)), found
            )
    return found


def _faces(apart: np.ndarray) -> np.ndarray:
    """Separation (...) from the gaps ``apart`` (...,3) along three perpendicular axes: the length
    of the gap vector."""
    largest = apart.max(axis=-1)
    return np.where(largest > 0.0, np.linalg.norm(np.maximum(apart, 0.0), axis=-1), largest)


def least(
    of: Callable[[np.ndarray], np.ndarray],
    begin: np.ndarray,
    end: np.ndarray,
    points: int,
    rounds: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest value (n,) of n functions ``of`` times (n,k) between ``begin`` and ``end`` (n,), and
    its time: on ``points`` instants, then ``rounds`` times on fewer between the neighbours of the
    best."""
    rows, low, high = np.arange(len(begin)), begin, end
    for count in (points, *[_AGAIN] * rounds):
        time = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, count)
        values = of(time)
        best = values.argmin(axis=1)
        low, high = time[rows, np.maximum(best - 1, 0)], time[rows, np.minimum(best + 1, count - 1)]
    return values[rows, best], time[rows, best]
