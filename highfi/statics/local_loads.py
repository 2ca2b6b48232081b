"""Loads of places that each act on a few degrees of freedom: the rows of a matrix of all loads that are
not zero."""

from itertools import pairwise

import numpy as np
from scipy.sparse import csc_array

_BATCH = 4_000_000  # numbers between places at once; bounds the memory


class LocalLoads:
    """``loads`` (d,pw) N of p places with ``width`` columns each, on degrees of freedom whose layers
    (d,) ascend."""

    def __init__(self, loads: csc_array, width: int, layer: np.ndarray):
        size, count = loads.shape[0], loads.shape[1] // width
        column = np.repeat(np.arange(loads.shape[1]), np.diff(loads.indptr))
        key, entry = np.unique(column // width * size + loads.indices, return_inverse=True)
        place, row = np.divmod(key, size)
        first = np.searchsorted(place, np.arange(count + 1))
        slot, entry = np.arange(key.size) - first[place], entry.reshape(-1)
        # (u,) degrees of freedom with a load at any place, ascending
        self.loaded, number = np.unique(row, return_inverse=True)
        most = int(np.diff(first).max(initial=1))
        held = np.diff(first) > 0
        # (p,n) numbers of ``loaded``; a place with fewer repeats its first one, without a load
        self._number = np.zeros((count, most), dtype=np.int64)
        self._number[held] = number.reshape(-1)[first[:-1][held], None]
        self._number[place, slot] = number.reshape(-1)
        self._load = np.zeros((count, most, width))  # N
        self._load[place[entry], slot[entry], column % width] = loads.data
        # (p,) first and last layer of each place; a place without a load is in the first one
        self.begin, self.end = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
        self.begin[held] = layer[row[first[:-1][held]]]
        self.end[held] = layer[row[first[1:][held] - 1]]

    def products(
        self, pairs: np.ndarray, between: np.ndarray, rows: int, columns: int
    ) -> np.ndarray:
        """Displacements (q,w,w) of the first place of each of the ``pairs`` (q,2) under the loads of
        the second, from the displacements ``between`` (a,b) m/N of the degrees of freedom from number
        ``rows`` of ``loaded`` on, under unit forces on those from number ``columns`` on."""
        width, most = self._load.shape[2], self._number.shape[1]
        found = np.empty((len(pairs), width, width))
        step = max(_BATCH // most**2, 1)
        for start, end in pairwise([*range(0, len(pairs), step), len(pairs)]):
            one, other = pairs[start:end].T
            row, column = self._number[one] - rows, self._number[other] - columns
            moved = between[row[:, :, None], column[:, None, :]] @ self._load[other]
            found[start:end] = self._load[one].transpose(0, 2, 1) @ moved
        return found
