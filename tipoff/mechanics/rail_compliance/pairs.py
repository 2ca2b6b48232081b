"""Tables between the faces on one rail. Faces on different rails do not move each other, and on four
rails they are three quarters of all pairs.

A table (s,f,m,p,q) holds at [:, i, k] the block (p,q) between face i and the k-th of the ``members`` of
its rail. If a rail has fewer faces than another one, its last blocks are zero.
"""

from collections.abc import Iterator

import numpy as np

_AT_ONCE = 1e7  # bytes of the stations of a table that are computed together


def few_stations(table: np.ndarray) -> Iterator[slice]:
    """Parts of the stations of a ``table`` (s,...): the intermediate results of all stations of a long
    rail would take several times its memory."""
    stations = len(table)
    most = max(1, int(_AT_ONCE * stations / max(table.nbytes, 1)))
    return (slice(first, first + most) for first in range(0, stations, most))


def members(rail: np.ndarray) -> np.ndarray:
    """Numbers (r,m), ascending, of the faces on each rail, from the ``rail`` (f,) of each face; -1
    fills up."""
    rails = [np.flatnonzero(rail == number) for number in range(rail.max(initial=0) + 1)]
    found = np.full((len(rails), max(own.size for own in rails)), -1)
    for row, own in zip(found, rails):
        row[: own.size] = own
    return found


def beside(rail: np.ndarray) -> np.ndarray:
    """Numbers (f,m) of the faces on the rail of each face; -1 fills up, and stands for a face without
    a rail (-1)."""
    return np.where(rail[:, None] >= 0, members(rail)[rail], -1)


def numbered(rail: np.ndarray, once: bool) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (f,m) of the stored blocks between each face and those ``beside`` it, -1 without one, and
    whether (f,m) a block is the stored one transposed. If they are stored ``once``, the later face of a
    pair has the block of the earlier one: symmetric tables differ between both by rounding alone."""
    near, count = beside(rail), 0
    number, turned = np.full(near.shape, -1), np.zeros(near.shape, dtype=np.bool_)
    for face, row in enumerate(near):
        for place, other in enumerate(row[row >= 0]):
            if once and other < face:
                turned[face, place] = True
                number[face, place] = number[other, near[other] == face][0]
            else:
                number[face, place] = count
                count += 1
    return number, turned


def of_rail(table: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Matrices (s,n p,n q) between the n faces ``own`` of one rail, all its members."""
    block = table[:, own, : own.size].transpose(0, 1, 3, 2, 4)
    return block.reshape(len(table), own.size * block.shape[2], -1)


def blocks(matrices: np.ndarray, faces: int) -> np.ndarray:
    """The part (s,n,n,p,q) of a table that ``of_rail`` returns as ``matrices`` for n ``faces``."""
    stations, rows, columns = matrices.shape
    found = matrices.reshape(stations, faces, rows // faces, faces, columns // faces)
    return found.transpose(0, 1, 3, 2, 4)


def transposed(table: np.ndarray, rail: np.ndarray) -> np.ndarray:
    """The table (s,f,m,q,p) with the blocks between each two faces transposed and interchanged."""
    near = beside(rail)
    place = (near < np.arange(rail.size)[:, None]).sum(axis=1) - (near < 0).sum(axis=1)
    found = table[:, near, place[:, None]].swapaxes(-1, -2)
    return np.where((near >= 0)[:, :, None, None], found, 0.0)


def on_both_sides(each: np.ndarray, table: np.ndarray, rail: np.ndarray) -> np.ndarray:
    """A_i T_ij A_j' for the matrices A (s,f,c,p) of ``each`` face."""
    found = np.zeros((*table.shape[:3], each.shape[2], each.shape[2]))
    for row in members(rail):
        own = row[row >= 0]
        for few in few_stations(table):
            part = np.einsum(
                "siab,sijbc,sjdc->sijad",
                each[few][:, own],
                table[few][:, own, : own.size],
                each[few][:, own],
                optimize=True,
            )
            found[few][:, own, : own.size] = part
    return found


def whole(table: np.ndarray, rail: np.ndarray) -> np.ndarray:
    """The table (s,f,p,f,q) between all faces."""
    stations, faces, _, rows, columns = table.shape
    found = np.zeros((stations, faces, rows, faces, columns))
    for face, near in enumerate(beside(rail)):
        own = near[near >= 0]
        found[:, face, :, own] = table[:, face, : own.size].transpose(1, 0, 2, 3)
    return found


def of_whole(table: np.ndarray, rail: np.ndarray) -> np.ndarray:
    """The pairs on one rail of a table (s,f,p,f,q) between all faces."""
    near = beside(rail)
    found = table.transpose(1, 3, 0, 2, 4)[np.arange(rail.size)[:, None], near]
    return np.where((near >= 0)[:, :, None, None], found.transpose(2, 0, 1, 3, 4), 0.0)


def is_positive(matrices: np.ndarray) -> bool:
    """Whether all symmetric matrices (s,n,n) are positive definite. A number that is not finite
    passes through a factorisation without an error."""
    try:
        return bool(np.isfinite(np.linalg.cholesky(matrices)).all())
    except np.linalg.LinAlgError:
        return False
