"""Hexahedra of a grid: the cells between planes normal to the three axes that are inside the
solid."""

from collections.abc import Sequence

import numpy as np

# VTK order
CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)


def filled(lines: list[np.ndarray], metal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (n,3) m and hexahedra (e,8), VTK order, of the cells of a grid where ``metal`` is
    true.

    ``lines``: ascending places (m) of the planes across each of three right-handed axes, p, q and r
    of them; ``metal`` (p-1,q-1,r-1). Points are numbered along the third axis first and along the
    first one last; elements have the order of ``np.argwhere(metal)``.
    """
    nodes = np.ravel_multi_index(
        np.moveaxis(np.argwhere(metal)[:, None] + CUBE, -1, 0), [len(line) for line in lines]
    )
    points = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    used, number = np.unique(nodes, return_inverse=True)
    return points[used], number.reshape(-1, 8)


def divided(line: np.ndarray, divisions: Sequence[int] | np.ndarray) -> np.ndarray:
    """All planes along an axis: ``line`` (b,) m, borders in order, with ``divisions`` (b-1,) equal
    cells between two of them."""
    pieces = [
        np.linspace(begin, end, count + 1)[:-1]
        for begin, end, count in zip(line, line[1:], divisions)
    ]
    return np.append(np.concatenate(pieces), line[-1])
