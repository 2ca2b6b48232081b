"""Strain at any point of eight-node hexahedra from the displacement of their corners, incompatible
modes included.

    du/dX = sum over corners of u_a (x) grad N_a + sum over bubbles of a_i (x) grad P_i,      a = -H^-1 L u
    grad N_a = J^-1 dN_a/dxi,       grad P_i = (det J0 / det J) 4 (1 - 2 xi_i) J0^-1 e_i

with J at the point, J0 at the centre, and the condensed amplitudes a of ``elements.hexahedron``. The
modes are those the stiffness was condensed with, so the stress does the same work as the element's
forces. At the centre the bubbles have no gradient. Elsewhere they carry the bending, for instance at
the corners of a wall one element thick. Stress is the law times the strain.

Source: Taylor, Beresford, Wilson, Int. J. Numer. Methods Eng. 10 (1976) 1211-1219; Wilson, Static
and Dynamic Analysis of Structures (2002), chapter 6, on stresses recovered with the incompatible
modes.
"""

import numpy as np

from tipoff.highfi.elements import hexahedron

NODES = hexahedron.VTK_CORNERS.astype(float)  # (8,3) places on the unit cube
CENTRE = np.full(3, 0.5)
_SHEAR = ((0, 1), (1, 2), (2, 0))  # components of xy, yz, zx


def gradients(corners: np.ndarray, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gradients 1/m of the corner functions (p,8,3) and of the bubbles (p,3,3) at p points.

    corners (p,8,3) m of the element around each point; local (p,3) its place on the unit cube.
    """
    inverse, jacobian, slopes = _mapping(corners, local)
    central, at_centre, _ = _mapping(corners, np.broadcast_to(CENTRE, local.shape))
    scale = at_centre / jacobian
    bubble = (scale[:, None] * 4.0 * (1.0 - 2.0 * local))[:, :, None] * np.swapaxes(central, 1, 2)
    return slopes @ np.swapaxes(inverse, 1, 2), bubble


def amplitudes(corners: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Bubble amplitudes (c,9,24) of unit displacements of the corners (c,8,3) m, numbered bubble *
    3 + component."""
    coupling, own = hexahedron.bubble_blocks(hexahedron.kinematics(hexahedron.basis(corners)), law)
    return -np.linalg.solve(own, coupling)


def strain_matrix(corners: np.ndarray, law: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Matrix (p,6,24) 1/m from the displacement of the corners, corner * 3 + component, to the
    strain at p points; see ``gradients``.

    Strain is ordered xx, yy, zz, xy, yz, zx, shear in engineering measure.
    """
    nodal, bubble = gradients(corners, local)
    matrix = hexahedron.strain_matrix(nodal)
    bending = (np.abs(local - CENTRE) > 0.0).any(axis=1)
    if bending.any():
        matrix[bending] += hexahedron.strain_matrix(bubble[bending]) @ amplitudes(
            corners[bending], law
        )
    return matrix


def corner_gradients(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At the corners of c elements: slopes (c,8,3,3) 1/m of local coordinate i along j, and
    gradients (c,8,3,3) of the bubbles."""
    count, local = len(corners), np.tile(NODES, (len(corners), 1))
    repeated = np.repeat(corners, 8, axis=0)
    inverse, _, _ = _mapping(repeated, local)
    _, bubble = gradients(repeated, local)
    return np.swapaxes(inverse, 1, 2).reshape(count, 8, 3, 3), bubble.reshape(count, 8, 3, 3)


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Equivalent stress (...) of (...,6) Pa: sqrt(((xx-yy)^2 + (yy-zz)^2 + (zz-xx)^2) / 2 + 3 (xy^2
    + yz^2 + zx^2))."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    apart = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * apart + 3.0 * (xy**2 + yz**2 + zx**2))


def _mapping(corners: np.ndarray, local: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Inverse Jacobian (p,3,3), its [j, i] the slope of local coordinate i along j; Jacobian (p,);
    slopes (p,8,3) of functions."""
    high = hexahedron.VTK_CORNERS == 1
    value = np.where(high, local[:, None], 1.0 - local[:, None])
    slope = np.where(high, 1.0, -1.0)
    others = value[:, :, [1, 2, 0]] * value[:, :, [2, 0, 1]]
    slopes = slope * others
    turned = np.swapaxes(slopes, 1, 2) @ corners
    return np.linalg.inv(turned), np.linalg.det(turned), slopes
