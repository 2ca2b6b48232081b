"""Products of loads with the inverse of the stiffness of a slender solid, from its elements, layer by layer.

The layers are those of ``statics.chain``, of nodes in place of degrees of freedom. The rows of one layer are
assembled when its turn comes, and no layer is kept: a solid of any length fits into memory.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from scipy.linalg.lapack import dpotrf, dtrtrs
from scipy.sparse import coo_array, csr_array

from tipoff.highfi.statics import chain
from tipoff.highfi.statics.assembly import Operator


class Slabs:
    """The layers of the free nodes of an ``operator``."""

    def __init__(self, operator: Operator):
        self._operator = operator
        number = np.cumsum(operator.free) - 1
        self._layers = [np.flatnonzero(operator.free)[each] for each in _layers(operator, number)]
        self._layer = np.full(operator.free.size, -1)
        self._place = np.zeros(operator.free.size, dtype=np.int64)  # of a node within its layer
        for layer, nodes in enumerate(self._layers):
            self._layer[nodes], self._place[nodes] = layer, np.arange(nodes.size)
        ahead = np.where(operator.free[operator.cells], self._layer[operator.cells], number.size)
        first = ahead.min(axis=1)
        self._cells = np.argsort(first, kind="stable")
        self._begins = np.searchsorted(first[self._cells], np.arange(len(self._layers) + 1))

    def products(self, loads: np.ndarray, report: Callable[[float], None]) -> np.ndarray:
        """Products F' K^-1 F (l,l) of ``loads`` F (3n,l) N: the displacement of each under each, in J.
        ``report`` gets the fraction that is done."""
        found = np.zeros((loads.shape[1], loads.shape[1]))
        coupled, z = np.zeros((0, 0)), np.zeros((0, 0))
        for layer, (block, coupling) in enumerate(self._blocks()):
            own = loads[_freedoms(self._layers[layer])]
            if layer:
                block -= coupled.T @ coupled
                own = own - coupled.T @ z
            lower = dpotrf(block, lower=True)[0]
            z = dtrtrs(lower, own, lower=True)[0]
            found += z.T @ z
            coupled = dtrtrs(lower, coupling, lower=True)[0] if coupling.size else coupling
            report((layer + 1) / len(self._layers))
        return found

    def _blocks(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Stiffness of each layer, and between it and the next one."""
        rest = np.zeros((0, 0))
        for layer, (own, after) in enumerate(pairwise([*self._layers, self._layers[0][:0]])):
            slab = self._slab(layer, own, after)
            size = 3 * own.size
            block = slab[:size, :size]
            if layer:
                block += rest
            rest = slab[size:, size:]
            yield np.asfortranarray(block), slab[:size, size:]

    def _slab(self, layer: int, own: np.ndarray, after: np.ndarray) -> np.ndarray:
        """Stiffness of the elements that begin in a ``layer`` with the nodes ``own``, and of its joints, in
        this layer and the one ``after`` it."""
        operator, size = self._operator, 3 * (own.size + after.size)
        elements = self._cells[self._begins[layer] : self._begins[layer + 1]]
        cells = operator.cells[elements]
        place = self._place[cells] + np.where(self._layer[cells] == layer, 0, own.size)
        freedoms = _freedoms(np.where(operator.free[cells], place, -1))
        inside = (freedoms[:, :, None] >= 0) & (freedoms[:, None, :] >= 0)
        flat = freedoms[:, :, None] * size + freedoms[:, None, :]
        values = operator.stiffness[operator.shape_class[elements]]
        slab = np.zeros((size, size))  # a last layer may have no element
        if len(cells):
            slab.ravel()[:] = np.bincount(flat[inside], values[inside], minlength=size**2)
        if operator.joints is not None:
            joints, first = operator.joints[_freedoms(own)], 3 * own.size
            slab[:first, :first] += joints[:, _freedoms(own)].toarray()
            slab[:first, first:] += joints[:, _freedoms(after)].toarray()
        return slab


def _layers(operator: Operator, number: np.ndarray) -> list[np.ndarray]:
    """The free nodes by layers, by their ``number`` (n,) among the free ones."""
    cells, inside = operator.cells, operator.free[operator.cells]
    element = np.repeat(np.arange(len(cells)), cells.shape[1]).reshape(cells.shape)
    size = int(number[-1]) + 1
    beside = csr_array(
        (np.ones(inside.sum(), dtype=np.int8), (element[inside], number[cells[inside]])),
        shape=(len(cells), size),
    )
    graph = csr_array(beside.T @ beside)
    if operator.joints is not None:
        joints = coo_array(operator.joints)
        ends = number[np.stack(joints.coords) // 3]
        graph = graph + csr_array((np.ones(ends.shape[1], dtype=np.int8), tuple(ends)), graph.shape)
    return chain.layers(csr_array(graph))


def _freedoms(nodes: np.ndarray) -> np.ndarray:
    """Degrees of freedom of ``nodes``; negative for a negative number."""
    return (3 * nodes[..., None] + np.arange(3)).reshape(*nodes.shape[:-1], 3 * nodes.shape[-1])
