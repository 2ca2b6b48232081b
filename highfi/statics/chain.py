"""Statics of a slender solid as a chain of layers: cost grows with the first power of its length.

The layers are the levels of a breadth-first search through the graph of the stiffness from one end
of the solid, in an extruded rail its stations. Each is coupled only to its neighbours, so the
stiffness is block-tridiagonal, with D_k on the diagonal and B_k between layers k and k+1. All layers
before k are condensed onto k (Schur complement). The inverse follows from behind, layer by layer::

    S_k = D_k - B_k-1' S_k-1^-1 B_k-1,    X_k = S_k^-1 B_k
    (K^-1)_kk = S_k^-1 + X_k (K^-1)_k+1,k+1 X_k',    (K^-1)_kl = -X_k (K^-1)_k+1,l,    k < l

Pads press few degrees of freedom of a layer, and many places of a pad share them. So displacements
of places follow from those of the degrees of freedom, with the loads f_i and f_j of two places::

    f_i' K^-1 f_j = sum over layers k of i and l of j of f_i,k' (K^-1)_kl f_j,l

Only layers of places that are pressed at the same travel are computed. Layers l form blocks, and each
block has one product of the X between it and the layers k before it.

Source: Golub and Van Loan, Matrix Computations, 4th ed. 2013, section 4.5.
"""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri
from scipy.sparse import csc_array, csr_array

from tipoff.highfi.statics.local_loads import LocalLoads

# Measured on an AMD EPYC at 2.6 GHz, s: a chain for each cube of a layer's width and for each layer,
# a sparse factor for each load and each square of a width, and products alone for each cube
_CUBE, _LAYER, _SQUARE = 3e-10, 1.5e-3, 1.1e-9
_CUBE_OF_PRODUCTS = 1e-10
_MOST_BYTES = 4e9  # of both matrices of each layer
_PASSES = 3  # of the search: it ends with the whole layer at one end as its start


def layers(stiffness: csr_array) -> list[np.ndarray]:
    """Numbers of the degrees of freedom of each layer; only neighbours are coupled."""
    start, found = np.zeros(1, dtype=np.int64), []
    for _ in range(_PASSES):
        found = _levels(stiffness, start)
        start = found[-1]
    return found


def _levels(matrix: csr_array, start: np.ndarray) -> list[np.ndarray]:
    """Levels of a breadth-first search from ``start``, and from another row where parts of the
    matrix are not coupled."""
    seen = np.zeros(matrix.shape[0], dtype=np.bool_)
    found: list[np.ndarray] = []
    left, level = seen.size, start
    while left:
        seen[level] = True
        found.append(level)
        left -= level.size
        reached = matrix[level].indices
        level = np.unique(reached[~seen[reached]])
        if left and not level.size:
            level = np.flatnonzero(~seen)[:1]
    return found


def seconds(count: float, width: float) -> float:
    """About the time (s) of ``slabs.Slabs.products`` with ``count`` layers of ``width`` degrees of
    freedom."""
    return count * (_CUBE_OF_PRODUCTS * width**3 + _LAYER)


def is_cheaper(order: list[np.ndarray], loads: int) -> bool:
    """Whether a chain of the layers ``order`` fits into memory and takes less time for so many
    ``loads`` than a general sparse factor."""
    width = np.array([layer.size for layer in order], dtype=float)
    chain = _CUBE * (width**3).sum() + _LAYER * width.size
    return 16.0 * (width**2).sum() < _MOST_BYTES and chain < _SQUARE * loads * (width**2).sum()


class Chain:
    """Factor of a symmetric positive definite ``stiffness`` (d,d) by its layers ``order``."""

    def __init__(self, stiffness: csc_array, order: list[np.ndarray]):
        self._order = np.concatenate(order)
        ends = np.cumsum([0, *(layer.size for layer in order)])
        self._parts = [slice(first, last) for first, last in pairwise(ends)]
        self._matrix = csr_array(stiffness)[self._order][:, self._order]
        self._inverse: list[np.ndarray] = []  # S_k^-1
        self._across: list[np.ndarray] = []  # S_k^-1 B_k
        coupling = condensed = np.zeros((0, 0))
        for layer in range(len(self._parts)):
            block = self._block(layer, layer)
            if layer:
                block -= coupling.T @ condensed
            self._inverse.append(_inverse(block))
            if layer + 1 < len(self._parts):
                coupling = self._block(layer, layer + 1)
                condensed = self._inverse[-1] @ coupling
                self._across.append(condensed)

    def _block(self, row: int, column: int) -> np.ndarray:
        part = self._parts[row]
        first, last = self._matrix.indptr[part.start], self._matrix.indptr[part.stop]
        own, columns = self._matrix.indptr[part.start : part.stop + 1] - first, self._parts[column]
        place = self._matrix.indices[first:last] - columns.start
        inside = (place >= 0) & (place < columns.stop - columns.start)
        found = np.zeros((part.stop - part.start, columns.stop - columns.start))
        rows = np.repeat(np.arange(len(found)), np.diff(own))
        found[rows[inside], place[inside]] = self._matrix.data[first:last][inside]
        return found

    def solve(self, loads: np.ndarray) -> np.ndarray:
        """Displacement (m) under ``loads`` (N), (d,) or (d,c)."""
        moved = loads[self._order]
        for part, after, across in zip(self._parts, self._parts[1:], self._across):
            moved[after] -= across.T @ moved[part]
        for layer in reversed(range(len(self._parts))):
            part = self._parts[layer]
            moved[part] = self._inverse[layer] @ moved[part]
            if layer < len(self._across):
                moved[part] -= self._across[layer] @ moved[self._parts[layer + 1]]
        found = np.empty_like(moved)
        found[self._order] = moved
        return found

    def under(
        self, loads: csc_array, pairs: np.ndarray, width: int, report: Callable[[float], None]
    ) -> np.ndarray:
        """Displacements (q,w,w) of the ``width`` loads of a place under those of another one, for
        the ``pairs`` (q,2) of places; ``loads`` (d,pw) N of p places. ``report`` gets the fraction
        that is done."""
        sizes = [part.stop - part.start for part in self._parts]
        layer = np.repeat(np.arange(len(sizes)), sizes)
        places = LocalLoads(csc_array(csr_array(loads)[self._order]), width, layer)
        if not places.loaded.size:
            return np.zeros((len(pairs), width, width))
        begin = places.begin
        # The second place of a pair is that which begins later.
        turned = begin[pairs[:, 0]] > begin[pairs[:, 1]]
        turned |= (begin[pairs[:, 0]] == begin[pairs[:, 1]]) & (pairs[:, 0] > pairs[:, 1])
        sorted_pairs = np.where(turned[:, None], pairs[:, ::-1], pairs)
        one, number = np.unique(sorted_pairs, axis=0, return_inverse=True)
        found = np.zeros((len(one), width, width))
        walls = _Walls(self._parts, places.loaded)
        for here, between, front, first in self._swept(walls, begin[one], places.end[one], report):
            found[here] = places.products(
                one[here], between, walls.starts[front], walls.starts[first]
            )
        every = found[number.reshape(-1)]
        return np.where(turned[:, None, None], every.transpose(0, 2, 1), every)

    def placed(self, freedoms: np.ndarray) -> np.ndarray:
        """Place of each of ``freedoms`` (u,) in the order of the layers."""
        place = np.empty(len(self._order), dtype=np.int64)
        place[self._order] = np.arange(place.size)
        return place[freedoms]

    def numbers(self, placed: np.ndarray) -> np.ndarray:
        """Numbers of the degrees of freedom at these places."""
        return self._order[placed]

    def layer(self, placed: np.ndarray) -> np.ndarray:
        """Layer of each place."""
        starts = [part.start for part in self._parts]
        return np.searchsorted(starts, placed, side="right") - 1

    def blocks(
        self, loaded: np.ndarray, layers: np.ndarray, report: Callable[[float], None]
    ) -> np.ndarray:
        """Displacements (q,w,w) m/N of the degrees of freedom ``loaded`` (u,), by their places
        (``placed``), ascending, in the first of two ``layers`` (q,2), under unit forces on those in the
        second, which is no earlier one. Layers with fewer than w have zeros."""
        walls = _Walls(self._parts, loaded)
        width = int(np.diff(walls.starts).max())
        found = np.zeros((len(layers), width, width))
        for here, between, front, first in self._swept(walls, layers, layers, report):
            for number in here:
                rows, columns = (
                    slice(
                        walls.starts[layer] - walls.starts[origin],
                        walls.starts[layer + 1] - walls.starts[origin],
                    )
                    for layer, origin in zip(layers[number], (front, first))
                )
                part = between[rows, columns]
                found[number, : part.shape[0], : part.shape[1]] = part
        return found

    def _swept(
        self,
        walls: "_Walls",
        begins: np.ndarray,
        ends: np.ndarray,
        report: Callable[[float], None],
    ) -> Iterator[tuple[np.ndarray, np.ndarray, int, int]]:
        """For pairs of places with the first layers ``begins`` (q,2), that of the second no earlier, and
        the last layers ``ends`` (q,2), block by block of layers: numbers of pairs, the displacements
        (``_between``) that they need, and the first layers of its rows and of its columns."""
        together, inverse = self._together(begins, walls), np.zeros((0, 0))
        count = len(self._parts)
        for first in reversed(range(0, count, together)):
            for layer in reversed(range(first, min(first + together, count))):
                inverse = self._inverse_at(layer, inverse)
                walls.keep(layer, inverse)
            here = np.flatnonzero((first <= begins[:, 1]) & (begins[:, 1] < first + together))
            if here.size:
                asked = _covered(begins[here, 0], ends[here, 0], count)
                front, last = min(first, int(begins[here, 0].min())), int(ends[here].max())
                yield here, self._between(walls, front, first, last, asked), front, first
            walls.forget(int(ends[begins[:, 1] < first].max(initial=-1)))
            report(1.0 - first / count)

    def _together(self, begins: np.ndarray, walls: "_Walls") -> int:
        """Number of layers in a block with the least work: the columns of its layers pass through half of
        it, and one square matrix through the layers before it, up to the first place of a pair."""
        span = int((begins[:, 1] - begins[:, 0]).max(initial=0))
        width, loaded = len(self._order) / len(self._parts), walls.loaded.size / len(self._parts)
        least = math.sqrt(2.0 * (span + 1) * width / max(loaded, 1.0))
        return int(np.clip(round(least), 1, len(self._parts)))

    def _inverse_at(self, layer: int, after: np.ndarray) -> np.ndarray:
        """(K^-1)_kk of a layer from that of the layer ``after`` it."""
        if layer == len(self._across):
            return self._inverse[layer]
        across = self._across[layer]
        return self._inverse[layer] + across @ after @ across.T

    def _between(
        self, walls: "_Walls", front: int, first: int, last: int, asked: np.ndarray
    ) -> np.ndarray:
        """Displacements (a,b) m/N of the loaded degrees of freedom of the layers ``front`` to ``last``
        under unit forces on those of ``first`` to ``last``; before ``first`` only of the layers that
        are ``asked`` for."""
        starts = walls.starts
        found = np.zeros((starts[last + 1] - starts[front], starts[last + 1] - starts[first]))
        moved = np.zeros((self._parts[last].stop - self._parts[last].start, 0))
        for layer in reversed(range(first, last + 1)):
            if layer < last:
                moved = -(self._across[layer] @ moved)
            moved = np.concatenate([walls.columns[layer], moved], axis=1)
            rows = slice(starts[layer] - starts[front], starts[layer + 1] - starts[front])
            found[rows, starts[layer] - starts[first] :] = moved[walls.local(layer)]
        square = found[starts[first] - starts[front] :]
        square[:] = np.triu(square) + np.triu(square, 1).T
        # One square matrix takes the place of more columns than it has.
        passed, source = (moved, None) if moved.shape[1] <= len(moved) else (None, moved)
        for layer in reversed(range(front, first)):
            across = self._across[layer]
            passed = -(across if passed is None else across @ passed)
            if asked[layer]:
                own = passed[walls.local(layer)]
                rows = slice(starts[layer] - starts[front], starts[layer + 1] - starts[front])
                found[rows] = own if source is None else own @ source
        return found


class _Walls:
    """The ``loaded`` degrees of freedom (u,), ascending, by the ``parts`` of each layer."""

    def __init__(self, parts: list[slice], loaded: np.ndarray):
        ends = [part.start for part in parts] + [parts[-1].stop]
        self.loaded, self._parts = loaded, parts
        self.starts: list[int] = np.searchsorted(loaded, ends).tolist()
        self.columns: dict[int, np.ndarray] = {}  # of (K^-1)_kk, of each layer that was kept

    def local(self, layer: int) -> np.ndarray:
        """Numbers within the ``layer`` of its loaded degrees of freedom."""
        return self.loaded[self.starts[layer] : self.starts[layer + 1]] - self._parts[layer].start

    def keep(self, layer: int, inverse: np.ndarray) -> None:
        """Keep the columns of the ``inverse`` (K^-1)_kk that the loads need."""
        self.columns[layer] = inverse[:, self.local(layer)]

    def forget(self, last: int) -> None:
        """Forget the layers after ``last``."""
        self.columns = {layer: own for layer, own in self.columns.items() if layer <= last}


def _covered(begin: np.ndarray, end: np.ndarray, count: int) -> np.ndarray:
    """Whether each of ``count`` layers is between the ``begin`` and the ``end`` (q,) of a place."""
    change = np.bincount(begin, minlength=count + 1) - np.bincount(end + 1, minlength=count + 1)
    return np.cumsum(change[:count]) > 0


def _inverse(block: np.ndarray) -> np.ndarray:
    """Inverse of a symmetric positive definite ``block``."""
    found = dpotri(dpotrf(block, lower=True)[0], lower=True)[0]  # zero above its diagonal
    return found + np.tril(found, -1).T
