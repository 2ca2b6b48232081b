"""Pressure patterns of a pad face on the wall under it, as nodal loads.

    f_na = 1/A integral N_n phi_a dA,    phi = 1, xi, eta, xi^2, ... (``mechanics.rail_compliance``)

over the part of the pad face (area A) that has a wall under it; N are the nodal functions of the
wall's facets. The face is divided into cells half as long as a facet, with 2 x 2 Gauss points each,
independent of the facets' borders. Nodal functions sum to one and reproduce the place, so force and
moment are exact; only their distribution to neighbouring nodes is approximate.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.highfi.mesh import facets as geometry
from tipoff.highfi.statics import wall_grid
from tipoff.mechanics.rail_compliance.patterns import MOST_DEGREE, powers

_CELLS_PER_FACET = 2  # along each edge
_SAME = 1e-9  # m, narrower parts have no pressure


class Pressed(NamedTuple):
    """Pressure patterns of one pad face."""

    # (p,p) integral of phi_a phi_b dA / A over the part of the face (area A) that has a wall
    gram: np.ndarray
    node: np.ndarray  # (n,) node numbers, ascending
    load: np.ndarray  # (p,n)


class Wall:
    """A wall of ``facets`` (m,k) between ``points`` (n,3) m in its plane, X and the axis ``across``.
    Facets are found by X, so a place costs the same on a long wall as on a short one."""

    def __init__(self, points: np.ndarray, facets: np.ndarray, across: int):
        self._facets = facets
        self._plane = points[facets][:, :, [0, across]]
        self._control = geometry.hull(self._plane)
        self._low, self._high = (
            self._control.min(axis=(0, 1)),
            self._control.max(axis=(0, 1)),
        )
        self._cell = np.median(np.ptp(self._plane, axis=1), axis=0) / _CELLS_PER_FACET
        self._order = np.argsort(self._control[:, :, 0].min(axis=1), kind="stable")
        self._starts = self._control[self._order, :, 0].min(axis=1)
        self._longest = np.ptp(self._control[:, :, 0], axis=1).max()
        self._grid = wall_grid.from_facets(facets, self._plane)
        self._across: dict[tuple[float, ...], wall_grid.Axis] = {}  # the same at every X

    def pressed(self, middle: np.ndarray, half: np.ndarray, patterns: int) -> Pressed | None:
        """The first so many ``patterns`` on a face with its ``middle`` (2,) m and ``half`` its size
        (2,) m along X and across it; None without a wall.

        xi and eta run from -1 to 1 over the face, opposite to the axis if ``half`` is negative.
        """
        if self._grid is None or (bounds := self._bounds(middle, half)) is None:
            return self.facet_by_facet(middle, half, patterns)
        return self._on_grid(self._grid, bounds, middle, half, patterns)

    def _bounds(self, middle: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Lowest and highest corner (2,) m of the part of a face that may have a wall; None without
        one."""
        low = np.maximum(middle - np.abs(half), self._low)
        high = np.minimum(middle + np.abs(half), self._high)
        return None if (high - low < _SAME).any() else (low, high)

    def facet_by_facet(self, middle: np.ndarray, half: np.ndarray, patterns: int) -> Pressed | None:
        """As ``pressed``, for facets of any shape."""
        if (bounds := self._bounds(middle, half)) is None:
            return None
        low, high = bounds
        place, area = _gauss(low, high, self._cell)
        near = self._near(low[0], high[0])
        found, facet, weight = located(self._plane[near], self._control[near], place)
        local = (place[found] - middle) / half
        phi = (local[:, None] ** powers(MOST_DEGREE)[:patterns]).prod(axis=2)
        part = area / (4.0 * np.abs(half).prod())
        node, number = np.unique(self._facets[near[facet]], return_inverse=True)
        share = np.zeros((len(found), node.size))
        share[np.arange(len(found))[:, None], number.reshape(weight.shape)] = weight
        return Pressed(part * phi.T @ phi, node, part * phi.T @ share)

    def _on_grid(
        self,
        grid: wall_grid.Grid,
        bounds: tuple[np.ndarray, np.ndarray],
        middle: np.ndarray,
        half: np.ndarray,
        patterns: int,
    ) -> Pressed:
        """As ``pressed`` between ``bounds`` on a wall that is a ``grid``."""
        low, high = bounds

        def sums(axis: int) -> wall_grid.Axis:
            place = _on_axis(low[axis], high[axis], self._cell[axis])
            return grid.along(axis, place, (place - middle[axis]) / half[axis], MOST_DEGREE)

        key = low[1], high[1], middle[1], half[1]
        x, y = sums(0), self._across.get(key) or self._across.setdefault(key, sums(1))
        i, j = powers(MOST_DEGREE)[:patterns].T
        part = (high - low).prod() / (4.0 * np.abs(half).prod() * x.moment[0] * y.moment[0])
        node = grid.nodes(x, y).ravel()
        order = np.argsort(node)
        load = (x.weight[i][:, :, None] * y.weight[j][:, None]).reshape(patterns, -1)
        gram = x.moment[i[:, None] + i] * y.moment[j[:, None] + j]
        return Pressed(part * gram, node[order], part * load[:, order])

    def _near(self, first: float, last: float) -> np.ndarray:
        """Facets, ascending, that may be between two X (m)."""
        slack = (1.0 + geometry.INSIDE) * self._longest
        begin, end = np.searchsorted(self._starts, [first - slack, last + slack])
        return np.sort(self._order[begin:end])


def _gauss(low: np.ndarray, high: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, float]:
    """Gauss points (q,2) of the rectangle from ``low`` to ``high`` in cells no larger than ``size``
    (2,), and the area of each."""
    axes = [_on_axis(*each) for each in zip(low, high, size)]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    return place, (high - low).prod() / len(place)


def _on_axis(low: float, high: float, size: float) -> np.ndarray:
    """Gauss points (q,) from ``low`` to ``high`` in cells no larger than ``size``, ascending."""
    count = max(math.ceil((high - low) / size - _SAME / size), 1)
    width = (high - low) / count
    return (
        low
        + width * (np.arange(count)[:, None] + 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)).ravel()
    )


def located(
    plane: np.ndarray, control: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the places (q,2) m inside a facet, the facet of each, and the values of its nodal
    functions there; ``plane`` and ``control`` (m,k,2) m are nodes and control points of the facets.
    A place on the border of two facets belongs to the first."""
    point, facet, values = every(plane, control, place)
    first = np.flatnonzero(np.diff(point, prepend=-1))  # points ascend
    return point[first], facet[first], values[first]


def every(
    plane: np.ndarray, control: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As ``located``, but a place on a border belongs to each facet there; places ascend."""
    slack = geometry.INSIDE * np.ptp(control, axis=1)
    low, high = control.min(axis=1) - slack, control.max(axis=1) + slack
    near = np.flatnonzero(((low < place.max(axis=0)) & (place.min(axis=0) < high)).all(axis=1))
    beside = [
        (low[near, axis] < place[:, None, axis]) & (place[:, None, axis] < high[near, axis])
        for axis in (0, 1)
    ]
    point, facet = np.nonzero(beside[0] & beside[1])
    facet = near[facet]
    values, inside = geometry.weights(plane[facet], place[point])
    return point[inside], facet[inside], values[inside]
