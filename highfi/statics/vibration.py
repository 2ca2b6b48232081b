"""Modes of vibration of a rail held at its mounts, with the lumped mass of the reference.

    K psi_m = omega_m^2 M psi_m,   psi_m' M psi_n = 1 where m is n, else 0

Source: Golub and Van Loan, Matrix Computations, 4th ed. 2013, section 10.3.6, block Lanczos.
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array

from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.statics.solve import one_thread

_BLOCK = 8  # vectors solved for at once
FEW = 600, 20  # degrees of freedom, and those for each mode: below, all modes are solved for
MOST = 400, 40  # vectors, and those for each mode: most modes converge with a quarter of them
_ACCURACY = 1e-12  # of a mode: its residual relative to its eigenvalue


def modes(
    stiffness: csc_array, mass: np.ndarray, solve: Callable[[np.ndarray], np.ndarray], count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (n,) rad/s, ascending, and shapes (d,n) 1/kg^0.5 of the lowest ``count`` modes
    over d free degrees of freedom, of ``stiffness`` (d,d) N/m and ``mass`` (d,) kg; ``solve``
    returns the displacement (m) under a load (N). The sign of a shape does not depend on the method:
    its product with a fixed random vector is positive.

    Raises ValueError if there are fewer modes, MeshError if they do not converge.
    """
    freedoms = mass.size
    if not 0 <= count <= freedoms:
        raise ValueError(f"modes: given {count!r}, expected 0 to {freedoms}")
    if count == 0:
        return np.zeros(0), np.zeros((freedoms, 0))
    # A fixed start gives the same bits each time. It is not symmetric: that would hide half of the
    # modes.
    start = np.random.default_rng(1).standard_normal((_BLOCK, freedoms))
    root = np.sqrt(mass)
    if freedoms < max(FEW[0], FEW[1] * count):  # the iteration would fill the space
        squares, shapes = eigh(
            stiffness.toarray() / root / root[:, None], subset_by_index=(0, count - 1)
        )
    else:
        with one_thread():
            squares, shapes = _lowest(start, lambda rows: root * solve((root * rows).T).T, count)
    return np.sqrt(squares), _signed(shapes / root[:, None], start[0])


def _lowest(
    start: np.ndarray, inverse: Callable[[np.ndarray], np.ndarray], count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Lowest eigenvalues (count,) and unit eigenvectors (d,count) of the matrix whose ``inverse``
    multiplies rows (b,d), from the rows ``start`` (b,d): Lanczos iteration with blocks of b vectors,
    all orthogonal to all others. The factor of a long rail is read once for all vectors of a block."""
    size, freedoms = start.shape
    basis = np.empty((4 * count + 2 * size, freedoms))
    projected = np.zeros((0, 0))  # the inverse, its upper triangle
    block, _ = np.linalg.qr(start.T)
    for known in range(size, min(freedoms, MOST[0] + MOST[1] * count), size):
        if known > len(basis):
            basis = np.concatenate([basis, np.empty_like(basis)])
        basis[known - size : known] = block.T
        rest = inverse(basis[known - size : known])
        column = np.zeros((known, size))
        for _ in range(2):  # once more, for the orthogonality that the first time loses
            part = basis[:known] @ rest.T
            rest -= part.T @ basis[:known]
            column += part
        block, below = np.linalg.qr(rest.T)
        projected = np.pad(projected, (0, size))
        projected[:, -size:] = column
        if known < count:
            continue
        values, shapes = eigh(projected, lower=False, subset_by_index=(known - count, known - 1))
        missing = np.linalg.norm(below @ shapes[-size:], axis=0)
        if (missing < _ACCURACY * values).all():
            return 1.0 / values[::-1], basis[:known].T @ shapes[:, ::-1]
    raise MeshError(
        f"the {count} lowest modes of a rail do not converge: its elements differ too much"
    )


def _signed(shapes: np.ndarray, start: np.ndarray) -> np.ndarray:
    return shapes * np.where(start @ shapes < 0.0, -1.0, 1.0)
