"""Walls whose facets are the rectangles of a grid, as on every extruded rail: integrals over a pad face
are products of integrals along both axes.

    sum over Gauss points of phi_a N_km = (sum over x of xi^i N_k(x)) (sum over y of eta^j N_m(y))
"""

from typing import NamedTuple

import numpy as np

_SAME = 1e-12  # m, nodes on one line


class Axis(NamedTuple):
    """Sums over the places of one axis under a face."""

    first: int  # number of the first line with a weight
    weight: np.ndarray  # (degree + 1, k) of the nodal functions, for each power
    moment: np.ndarray  # (2 degree + 1,) of each power


class Grid(NamedTuple):
    """Lines (m), ascending, along X and across it, and the node (x,y) at each crossing."""

    lines: tuple[np.ndarray, np.ndarray]
    node: np.ndarray

    def along(self, axis: int, places: np.ndarray, local: np.ndarray, degree: int) -> Axis:
        """Sums over ``places`` (q,) m, ascending, with the coordinate ``local`` (q,) of the face, up to
        this ``degree``."""
        line = self.lines[axis]
        left = (np.searchsorted(line, places) - 1).clip(0, line.size - 2)
        part = (places - line[left]) / (line[left + 1] - line[left])
        powers = local ** np.arange(2 * degree + 1)[:, None]
        first, point = int(left[0]), np.arange(places.size)
        value = np.zeros((places.size, left[-1] + 2 - first))
        value[point, left - first] = 1.0 - part
        value[point, left - first + 1] = part
        return Axis(first, powers[: degree + 1] @ value, powers.sum(axis=1))

    def nodes(self, x: Axis, y: Axis) -> np.ndarray:
        """Numbers (k,m) of the nodes of both sums."""
        return self.node[
            x.first : x.first + x.weight.shape[1], y.first : y.first + y.weight.shape[1]
        ]


def from_facets(facets: np.ndarray, plane: np.ndarray) -> Grid | None:
    """The grid of ``facets`` (m,k) with nodes ``plane`` (m,k,2) m; None if they are not the rectangles
    of one, each once."""
    if facets.shape[1] != 4:
        return None
    lines, numbers = zip(*(_lines(plane[:, :, axis]) for axis in (0, 1)))
    if any(
        np.abs(line[own] - plane[:, :, axis]).max() > _SAME
        for axis, (line, own) in enumerate(zip(lines, numbers))
    ):
        return None
    low = [own.min(axis=1) for own in numbers]
    corner = [own - least[:, None] for own, least in zip(numbers, low)]
    is_rectangle = np.sort(2 * corner[0] + corner[1], axis=1) == np.arange(4)
    size = lines[0].size - 1, lines[1].size - 1
    if len(facets) != size[0] * size[1] or not is_rectangle.all():
        return None
    node = np.full((lines[0].size, lines[1].size), -1)
    node[numbers] = facets
    once = np.unique(low[0] * size[1] + low[1]).size == len(facets)
    return Grid(lines, node) if once and np.array_equal(node[numbers], facets) else None


def _lines(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Different ``values``, ascending, and the number of that of each."""
    every = np.unique(values)
    line = every[np.diff(every, prepend=-np.inf) > _SAME]
    return line, np.searchsorted(line, values, side="right") - 1
