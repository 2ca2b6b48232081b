"""Modes of vibration of a rail held at its mounts, with the lumped mass of the reference.

K psi_m = omega_m^2 M psi_m,   psi_m' M psi_n = 1 where m is n, else 0
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import LinearOperator, eigsh

from tipoff.highfi.statics.solve import one_thread


def modes(
    stiffness: csc_array, mass: np.ndarray, solve: Callable[[np.ndarray], np.ndarray], count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (n,) rad/s, ascending, and shapes (d,n) 1/kg^0.5 of the lowest ``count`` modes
    over d free degrees of freedom, of ``stiffness`` (d,d) N/m and ``mass`` (d,) kg; ``solve``
    returns the displacement (m) under a load (N). The sign of a shape does not depend on the method:
    its product with a fixed random vector is positive.

    Raises ValueError if there are fewer modes.
    """
    freedoms = mass.size
    if not 0 <= count <= freedoms:
        raise ValueError(f"modes: given {count!r}, expected 0 to {freedoms}")
    if count == 0:
        return np.zeros(0), np.zeros((freedoms, 0))
    # A fixed start vector gives the same bits each time. It is not symmetric: that would hide half
    # of the modes.
    start = np.random.default_rng(1).standard_normal(freedoms)
    if 2 * count > freedoms:  # too many for the iteration
        root = np.sqrt(mass)
        squares, shapes = eigh(
            stiffness.toarray() / root / root[:, None], subset_by_index=(0, count - 1)
        )
        return np.sqrt(squares), _signed(shapes / root[:, None], start)
    with one_thread():
        squares, shapes = eigsh(
            stiffness,
            count,
            diags_array(mass),
            sigma=0.0,
            v0=start,
            OPinv=LinearOperator(stiffness.shape, matvec=solve, dtype=float),
        )
    return np.sqrt(squares), _signed(shapes, start)


def _signed(shapes: np.ndarray, start: np.ndarray) -> np.ndarray:
    return shapes * np.where(start @ shapes < 0.0, -1.0, 1.0)
