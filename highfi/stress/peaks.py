"""Peaks and displacement gradients of a mesh of either kind of element: one kernel for each kind."""

import math

import numpy as np

from tipoff.highfi.stress import hexahedral_peaks, tetrahedral_peaks
from tipoff.highfi.stress.peak import Peak

_KERNELS = {8: hexahedral_peaks, 10: tetrahedral_peaks}  # by the nodes of an element
SIZE = max(kernels.SIZE for kernels in _KERNELS.values())  # workspace of one element

Recovery = hexahedral_peaks.Recovery | tetrahedral_peaks.Recovery


def build(
    points: np.ndarray,
    cells: np.ndarray,
    shape_class: np.ndarray,
    law: np.ndarray,
    number: np.ndarray,
) -> Recovery:
    """Recovery of a mesh, points (n,3) m and cells (e,k), with the classes of its operator; ``law``
    (6,6) Pa; ``number`` (n,) of each node in the nodal arrays."""
    return _KERNELS[cells.shape[1]].build(points, cells, shape_class, law, number)


def find(
    displacement: np.ndarray,
    recovery: Recovery,
    peak: Peak,
    space: np.ndarray,
    first: int,
    last: int,
) -> None:
    """Raise ``peak`` to the values of elements ``first`` to ``last`` under displacement (n,3) m;
    ``space`` (SIZE,) is workspace."""
    _KERNELS[recovery.cells.shape[1]].find(displacement, recovery, peak, space, first, last)


def gradients(
    displacement: np.ndarray, recovery: Recovery, space: np.ndarray, first: int, last: int
) -> np.ndarray:
    """Displacement gradients (last - first,k,3,3) at the nodes of elements ``first`` to ``last``:
    component, axis."""
    nodes = recovery.cells.shape[1]
    found = np.empty((last - first, 9 * nodes))
    _KERNELS[nodes].gradients(displacement, recovery, space, first, last, found)
    return found.reshape(-1, 3, 3, nodes).transpose(0, 3, 1, 2)


def samples_between(recovery: Recovery, steps_per_sample: int, share: float) -> int:
    """Samples between two scans of all elements, such that scans take at most ``share`` of a
    run."""
    return math.ceil(_KERNELS[recovery.cells.shape[1]].STEPS / (share * steps_per_sample))
