"""Quadrilaterals in a few blocks: each block has a grid, and blocks that share an edge have the same
nodes on it.

Opposite edges of a block have as many divisions. So all edges of a strand, from block to block, have
one number, from their mean length.
"""

import numpy as np
import scipy  # its submodules load at their first use

_SAME = 1e-9  # m: corners closer than this are one
_EDGES = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])


def divided(blocks: np.ndarray, element_size: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (s,2) m and anticlockwise corners (q,4) of quadrilaterals about ``element_size`` (m) in
    ``blocks`` (b,4,2) m of anticlockwise corners."""
    counts = _divisions(blocks, element_size)
    places, quads, first = [], [], 0
    for block, (along, up) in zip(blocks, counts):
        x, y = np.meshgrid(np.linspace(0, 1, along + 1), np.linspace(0, 1, up + 1), indexing="ij")
        weights = np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y], axis=-1)
        places.append((weights @ block).reshape(-1, 2))
        corner = first + np.arange((along + 1) * (up + 1)).reshape(along + 1, up + 1)
        quads.append(
            np.stack([corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=-1)
        )
        first += corner.size
    every = np.concatenate(places)
    number, kept = _unique(every)
    return every[kept], number[np.concatenate([each.reshape(-1, 4) for each in quads])]


def _divisions(blocks: np.ndarray, element_size: float) -> np.ndarray:
    """Divisions (b,2) of the first and the second edge of each block."""
    corner, _ = _unique(blocks.reshape(-1, 2))
    edges = np.sort(corner.reshape(-1, 4)[:, _EDGES], axis=2)
    _, number = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    number = number.reshape(-1, 4)
    pairs = np.concatenate([number[:, [0, 2]], number[:, [1, 3]]])
    graph = scipy.sparse.csr_array((np.ones(len(pairs)), pairs.T), shape=(number.max() + 1,) * 2)
    _, strand = scipy.sparse.csgraph.connected_components(graph, directed=False)
    lengths = np.linalg.norm(np.diff(blocks[:, _EDGES], axis=2)[:, :, 0], axis=2)
    own = strand[number]
    mean = np.bincount(own.ravel(), lengths.ravel()) / np.bincount(own.ravel())
    return np.maximum(1, np.round(mean / element_size).astype(int))[own[:, :2]]


def _unique(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number (n,) of the point at each of the ``places`` (n,2) m, and one place of each point."""
    cells = np.round(places / _SAME).astype(np.int64)
    _, kept, number = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    return number.reshape(-1), kept
