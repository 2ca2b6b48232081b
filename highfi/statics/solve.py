"""Linear statics of a rail held by its mounts: K u = f over the free nodes, one factorisation
for many loads."""

from functools import cache

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu
from threadpoolctl import ThreadpoolController

from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.chain import Chain, is_cheaper, layers


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()


def one_thread():
    """Context in which BLAS uses one thread. The dense blocks of a sparse factor are small: more
    threads would wait for each other and take several times the processor time. Results do not
    depend on it."""
    return _libraries().limit(limits=1, user_api="blas")


def _factored(stiffness: csc_array):
    """The sparse factor. Raises MemoryError, with the remedy, if it does not fit into memory."""
    try:
        return splu(
            stiffness,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except MemoryError:
        freedoms = f"the statics of a rail with {stiffness.shape[0]:,} degrees of freedom"
        raise MemoryError(f"{freedoms}; larger elements need less: studies.element_size") from None


class Clamped:
    """The ``stiffness`` of ``operator`` for its ``free`` degrees of freedom, the fixed nodes held.
    With many ``loads`` a slender rail has the factor ``chain``, else it is None and the factor is
    sparse. Raises MeshError if nothing holds it, and MemoryError."""

    def __init__(self, operator: assembly.Operator, loads: int = 0):
        self._joints = operator.joints
        if operator.free.all() and (self._joints is None or not self._joints.nnz):
            raise MeshError(
                "a rail that pads press, or that is warm, has no mount: nothing holds it"
            )
        self.free = np.repeat(operator.free, 3)
        self._free_rows: csr_array = assembly.sparse(operator)[self.free]
        self.stiffness = csc_array(self._free_rows[:, self.free])
        self.chain: Chain | None = None
        if loads:
            order = layers(csr_array(self.stiffness))
            if is_cheaper(order, loads):
                with one_thread():
                    self.chain = Chain(self.stiffness, order)
                return
        # A positive definite matrix needs no pivoting; an ordering for symmetric matrices keeps its
        # factors sparse.
        with one_thread():
            self._factor = _factored(self.stiffness)

    def solve(self, loads: np.ndarray) -> np.ndarray:
        """Displacement (m) of the free degrees of freedom under ``loads`` (N) on them, (3k,) or
        (3k,c)."""
        with one_thread():
            return (self.chain or self._factor).solve(loads)

    def displaced(self, loads: np.ndarray, held: np.ndarray) -> np.ndarray:
        """Displacement (3n,c) m under ``loads`` (3n,c) N and prescribed displacements ``held``
        (3n,c) m of the fixed degrees of freedom, or of the platform side of joints."""
        if self._joints is not None:
            loads = loads + self._joints @ held
        found = np.where(self.free[:, None], 0.0, held)
        found[self.free] = self.solve(loads[self.free] - self._free_rows @ found)
        return found
