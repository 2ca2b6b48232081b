"""Rail compliance on joints whose stiffness is multiplied by a factor g, from one set of solutions
at g = 1.

K is the stiffness of the rail on its joints, S = B B' that of the joints alone, and L the load of a
pattern under a face. With B' K^-1 B = Q diag(a) Q' the formula of Woodbury gives, exactly::

    L' [K + (g - 1) S]^-1 L = L' K^-1 L - sum_i h_i d_i d_i'
    d_i = L' K^-1 B Q_i,    h_i = (g - 1) / (1 + (g - 1) a_i),    0 < a_i <= 1

Terms that are small under every pad are left out (``TERMS``). The thermal displacement follows in
the same way. The modes are found by the method of Rayleigh and Ritz among the modes at g = 1/4, 1
and 4. Their part of the compliance is never more than the whole, so the rest stays positive
semidefinite.

Source: Golub and Van Loan, Matrix Computations, 4th ed. 2013, section 2.1.4; Bathe, Finite Element
Procedures, 1996, section 11.3.2.
"""

from typing import NamedTuple

import numpy as np

from tipoff.mechanics.rail_compliance import pairs

LEAST, MOST = 0.25, 4.0  # factors between which the modes are accurate
TERMS = 1e-7  # relative to the displacement under a pad: sum of the terms that are left out


class JointTerms(NamedTuple):
    """Effect of a factor on the stiffness of the joints, for r rails, n terms and m shapes."""

    share: np.ndarray  # (r,n) a
    moved: np.ndarray  # (s,f,p,n) 1/N^0.5 m^0.5, d under the faces
    moved_first: np.ndarray  # (s,f,d,n) as ``moved``, projected on the first d patterns
    moved_by_friction: np.ndarray  # (s,f,d,n) 1/N^0.5 m^0.5, by traction along X in these
    heated: np.ndarray  # (r,n,t) N^0.5 m^0.5, part of each term in the load of each thermal field
    shape: np.ndarray  # (s,f,p,m) 1/kg^0.5, displacement in orthonormal shapes that span the modes
    dragged_shape: np.ndarray  # (s,f,d,m) 1/kg^0.5, along X in these shapes
    stiffness: np.ndarray  # (r,m,m) 1/s2, of the rail on its joints in these shapes
    joint: np.ndarray  # (r,m,m) 1/s2, of the joints alone


def _weights(terms: JointTerms, factor: float) -> np.ndarray:
    """h (r,n)."""
    return (factor - 1.0) / (1.0 + (factor - 1.0) * terms.share)


def flexibility(
    terms: JointTerms, factor: float, nominal: np.ndarray, rail: np.ndarray
) -> np.ndarray:
    """Flexibility (s,f,m,p,p) m/N at a ``factor``, from the ``nominal`` one; ``rail`` (f,): number
    of the rail of each face."""
    return nominal - _together(terms, factor, (terms.moved, terms.moved), rail)


def dragged(terms: JointTerms, factor: float, nominal: np.ndarray, rail: np.ndarray) -> np.ndarray:
    """As ``flexibility`` for the displacement (s,f,m,d,d) m/N by friction."""
    change = _together(terms, factor, (terms.moved_first, terms.moved_by_friction), rail)
    return nominal - 0.5 * (change + pairs.transposed(change, rail))


def _together(
    terms: JointTerms, factor: float, both: tuple[np.ndarray, np.ndarray], rail: np.ndarray
) -> np.ndarray:
    """Sum (s,f,m,p,p) of the products of the terms of ``both`` (s,f,p,n) loads."""
    weights, (stations, faces, patterns, _) = _weights(terms, factor), both[0].shape
    rails = pairs.members(rail)
    found = np.zeros((stations, faces, rails.shape[1], patterns, patterns))
    for weight, row in zip(weights, rails):
        own = row[row >= 0]
        flat, other = (each[:, own].reshape(stations, own.size * patterns, -1) for each in both)
        change = (flat * weight) @ other.transpose(0, 2, 1)
        found[:, own, : own.size] = pairs.blocks(change, own.size)
    return found


def modes(
    terms: JointTerms, factor: float, count: int, rail: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies (r,n) rad/s of the lowest ``count`` modes at a ``factor``, their shapes
    (s,f,p,n) 1/kg^0.5, and those along X (s,f,d,n)."""
    squares, vectors = np.linalg.eigh(terms.stiffness + (factor - 1.0) * terms.joint)
    # The largest entry is positive, for any sign from the library.
    vectors = vectors[..., :count]
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=1)[:, None], axis=1)
    vectors = vectors * np.sign(largest)
    shape, dragged_shape = (
        np.einsum("sfpm,fmn->sfpn", each, vectors[rail])
        for each in (terms.shape, terms.dragged_shape)
    )
    return np.sqrt(squares[:, :count]), shape, dragged_shape


def warm(terms: JointTerms, factor: float, nominal: np.ndarray, rail: np.ndarray) -> np.ndarray:
    """Displacement (t,s,f,p) m for a unit of each thermal field at a ``factor``; the last field,
    the strain of the platform, loads only the joints."""
    part = _weights(terms, factor)[:, :, None] * terms.heated
    found = nominal - np.einsum("sfpn,fnt->tsfp", terms.moved, part[rail])
    found[-1] *= factor
    return found
