"""Statics of a slender solid as a chain of layers: cost grows with the first power of its length.

The layers are the levels of a breadth-first search through the graph of the stiffness from one end
of the solid, in an extruded rail its stations. Each is coupled only to its neighbours, so the
stiffness is block-tridiagonal, with D_k on the diagonal and B_k between layers k and k+1. All layers
before k, or after it, are condensed onto k (Schur complements)::

    S_k = D_k - B_k-1' S_k-1^-1 B_k-1,    R_k = D_k - B_k R_k+1^-1 B_k',    (K^-1)_kk = (S_k + R_k - D_k)^-1

The loads f_i and f_j of two places are condensed in the same way: y onto a layer from those before
it, v from those after it. With m the later one of the first layers of both places, that of j::

    f_i' K^-1 f_j = (y_i + v_i - f_i)_m' (K^-1)_mm v_j,m + sum over k > m of v_i,k' R_k^-1 v_j,k

So a load is condensed only over the layers between places that are pressed at the same travel.

Source: Golub and Van Loan, Matrix Computations, 4th ed. 2013, section 4.5.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.linalg import cho_solve
from scipy.linalg.lapack import dpotrf, dpotri, dtrtrs
from scipy.sparse import csc_array, csr_array

# Measured on an AMD EPYC at 2.6 GHz, s: a chain for each cube of a layer's width and for each layer,
# and a sparse factor for each load and each square of a width
_CUBE, _LAYER, _SQUARE = 3e-10, 1.5e-3, 1.1e-9
_MOST_BYTES = 4e9  # of both matrices of each layer
_BEHIND = 0.8  # share of the work on places that is done from behind
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
    """About the time (s) to factor ``count`` layers of ``width`` degrees of freedom."""
    return count * (_CUBE * width**3 + _LAYER)


def is_cheaper(order: list[np.ndarray], loads: int) -> bool:
    """Whether a chain of the layers ``order`` fits into memory and takes less time for so many
    ``loads`` than a general sparse factor."""
    width = np.array([layer.size for layer in order], dtype=float)
    chain = _CUBE * (width**3).sum() + _LAYER * width.size
    return 16.0 * (width**2).sum() < _MOST_BYTES and chain < _SQUARE * loads * (width**2).sum()


class Layered:
    """A ``stiffness`` (d,d) by its layers ``order``."""

    def __init__(self, stiffness: csc_array | csr_array, order: list[np.ndarray]):
        self._order = np.concatenate(order)
        ends = np.cumsum([0, *(layer.size for layer in order)])
        self._parts = [slice(first, last) for first, last in pairwise(ends)]
        self._matrix = csr_array(stiffness)[self._order][:, self._order]

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

    def products(self, loads: np.ndarray, report: Callable[[float], None]) -> np.ndarray:
        """Products F' K^-1 F (l,l) of ``loads`` F (d,l) N: the displacement of each under each, in J.
        Layers that are done are not kept, so a solid of any length fits into memory. ``report`` gets
        the fraction that is done."""
        placed = loads[self._order]
        found = np.zeros((loads.shape[1], loads.shape[1]))
        coupled, z = np.zeros((0, 0)), np.zeros((0, 0))
        for layer, part in enumerate(self._parts):
            block, own = self._block(layer, layer), placed[part]
            if layer:
                block -= coupled.T @ coupled
                own = own - coupled.T @ z
            lower = dpotrf(block, lower=True)[0]
            z = dtrtrs(lower, own, lower=True)[0]
            found += z.T @ z
            if layer + 1 < len(self._parts):
                coupled = dtrtrs(lower, self._block(layer, layer + 1), lower=True)[0]
            report((layer + 1) / len(self._parts))
        return found


class Chain(Layered):
    """Factor of a symmetric positive definite ``stiffness`` (d,d) by its layers ``order``."""

    def __init__(self, stiffness: csc_array, order: list[np.ndarray]):
        super().__init__(stiffness, order)
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
        placed = csr_array(loads[self._order])
        begin, end = self._reach(placed, width)
        # The second place of a pair is that which begins later.
        turned = begin[pairs[:, 0]] > begin[pairs[:, 1]]
        turned |= (begin[pairs[:, 0]] == begin[pairs[:, 1]]) & (pairs[:, 0] > pairs[:, 1])
        sorted_pairs = np.where(turned[:, None], pairs[:, ::-1], pairs)
        one, number = np.unique(sorted_pairs, axis=0, return_inverse=True)
        found = np.zeros((len(one), width, width))
        moved = self._from_behind(placed, (begin, end), one, found, report)
        self._from_front(placed, begin, one, found, moved, report)
        every = found[number.reshape(-1)]
        return np.where(turned[:, None, None], every.transpose(0, 2, 1), every)

    def _reach(self, placed: csr_array, width: int) -> tuple[np.ndarray, np.ndarray]:
        """First and last layer (p,) of the loads of each place."""
        layer = np.repeat(
            np.arange(len(self._parts)), [part.stop - part.start for part in self._parts]
        )
        rows, columns = placed.nonzero()
        begin = np.full(placed.shape[1] // width, len(self._parts))
        end = np.full(begin.size, -1)
        np.minimum.at(begin, columns // width, layer[rows])
        np.maximum.at(end, columns // width, layer[rows])
        return begin, end

    def _from_behind(
        self,
        placed: csr_array,
        reach: tuple[np.ndarray, np.ndarray],
        pairs: np.ndarray,
        found: np.ndarray,
        report: Callable[[float], None],
    ) -> np.ndarray:
        """Adds to ``found`` the terms of all ``pairs`` with loads condensed from behind. Returns
        the displacement (p,w,n) of each place in its first layer."""
        (begin, end), width = reach, found.shape[1]
        widest = max(part.stop - part.start for part in self._parts)
        moved = np.zeros((begin.size, width, widest))
        seconds = begin[pairs[:, 1]]
        shared = np.minimum(end[pairs[:, 0]], end[pairs[:, 1]])
        active, z, coupled = np.zeros(0, dtype=np.int64), np.zeros((0, 0)), np.zeros((0, 0))
        for layer in reversed(range(len(self._parts))):
            part = self._parts[layer]
            size = part.stop - part.start
            block = self._block(layer, layer)
            if coupled.size:
                block -= coupled.T @ coupled
            here = np.flatnonzero((begin <= layer) & (layer <= end))
            own = _columns(placed[part], here, width)
            v = own.copy()
            if active.size:
                kept = _spread(np.searchsorted(here, active), width)
                v[:, kept] -= coupled.T @ z
            starting = np.flatnonzero(begin[here] == layer)
            if starting.size:
                whole = block - (
                    self._block(layer - 1, layer).T @ self._across[layer - 1] if layer else 0.0
                )
                factor = dpotrf(whole, lower=True)[0], True
                u = cho_solve(factor, v[:, _spread(starting, width)], check_finite=False)
                moved[here[starting], :, :size] = u.T.reshape(-1, width, size)
                now = np.flatnonzero((seconds == layer) & (layer <= end[pairs[:, 0]]))
                first = np.searchsorted(here, pairs[now, 0])
                second = np.searchsorted(here[starting], pairs[now, 1])
                found[now] += _picked((v - own).T @ u, first, second, width)
            going = np.flatnonzero(begin[here] < layer)
            active = here[going]
            lower = dpotrf(block, lower=True)[0]
            if layer:
                coupled = dtrtrs(lower, self._block(layer - 1, layer).T, lower=True)[0]
            if active.size:
                z = dtrtrs(lower, v[:, _spread(going, width)], lower=True)[0]
                both = np.flatnonzero((seconds < layer) & (layer <= shared))
                first, second = np.searchsorted(active, pairs[both].T)
                found[both] += _picked(z.T @ z, first, second, width)
            report(_BEHIND * (1.0 - layer / len(self._parts)))
        return moved

    def _from_front(
        self,
        placed: csr_array,
        begin: np.ndarray,
        pairs: np.ndarray,
        found: np.ndarray,
        moved: np.ndarray,
        report: Callable[[float], None],
    ) -> None:
        """Adds to ``found`` the terms of all ``pairs`` with loads condensed from the front."""
        width = found.shape[1]
        until, seconds = begin.copy(), begin[pairs[:, 1]]
        np.maximum.at(until, pairs[:, 0], seconds)
        active, y = np.zeros(0, dtype=np.int64), np.zeros((0, 0))
        for layer, part in enumerate(self._parts):
            here = np.flatnonzero((begin <= layer) & (layer <= until))
            before, y_before = active, y
            active, y = here, _columns(placed[part], here, width)
            left = until[before] >= layer
            if left.any():
                kept = _spread(np.searchsorted(here, before[left]), width)
                passed = y_before[:, _spread(np.flatnonzero(left), width)]
                y[:, kept] -= self._across[layer - 1].T @ passed
            now = np.flatnonzero(seconds == layer)
            if now.size:
                starting = np.flatnonzero(begin == layer)
                u = moved[starting, :, : part.stop - part.start].reshape(starting.size * width, -1)
                first = np.searchsorted(here, pairs[now, 0])
                second = np.searchsorted(starting, pairs[now, 1])
                found[now] += _picked(y.T @ u.T, first, second, width)
            report(_BEHIND + (1.0 - _BEHIND) * (layer + 1) / len(self._parts))


def _inverse(block: np.ndarray) -> np.ndarray:
    """Inverse of a symmetric positive definite ``block``."""
    found = dpotri(dpotrf(block, lower=True)[0], lower=True)[0]  # zero above its diagonal
    return found + np.tril(found, -1).T


def _spread(places: np.ndarray, width: int) -> np.ndarray:
    """Columns of ``places`` with ``width`` each."""
    return (places[:, None] * width + np.arange(width)).ravel()


def _columns(placed: csr_array, places: np.ndarray, width: int) -> np.ndarray:
    """Dense columns (n,aw) of ``places`` (a,) of sparse rows; no other place has entries there that
    are needed."""
    found = np.zeros((placed.shape[0], places.size * width))
    rows = np.repeat(np.arange(placed.shape[0]), np.diff(placed.indptr))
    place, column = placed.indices // width, placed.indices % width
    number: np.ndarray = np.searchsorted(places, place)
    inside = np.isin(place, places)
    found[rows[inside], number[inside] * width + column[inside]] = placed.data[inside]
    return found


def _picked(product: np.ndarray, first: np.ndarray, second: np.ndarray, width: int) -> np.ndarray:
    """Blocks (q,w,w) of a ``product`` of columns of places."""
    return product.reshape(-1, width, product.shape[1] // width, width)[first, :, second]
