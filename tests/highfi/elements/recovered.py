"""Strain and stress of an element from the displacement of its nodes, as plain formulas."""

import numpy as np

from tipoff.highfi.elements import hexahedral_recovery, hexahedron


def strain(
    recovery, places: np.ndarray, law: np.ndarray, local: np.ndarray, displacement: np.ndarray
) -> np.ndarray:
    """Strain (p,6) at p points from the displacement (p,n,3) m of the nodes at ``places`` (p,n,3)
    m around each; ``recovery`` is the module of the element."""
    matrix = recovery.strain_matrix(places, law, local)
    return (matrix @ displacement.reshape(len(displacement), -1, 1))[..., 0]


def centre_strain(corners: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Strain (c,6) at the centre, where the bubbles have no gradient; displacement (c,8,3) m.
    Stress is `strain @ law`."""
    strain = hexahedron.kinematics(
        hexahedron.basis(corners, quadrature=(np.full((3, 1), 0.5), np.ones(1)))
    )
    return np.einsum("csd,cd->cs", strain.nodal[:, 0], displacement.reshape(-1, 24))


def corner_matrix(corners: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Matrix (c,8,6,24) Pa/m from the displacement of the corners (c,8,3) m to the stress at each
    corner."""
    count, local = len(corners), np.tile(hexahedral_recovery.NODES, (len(corners), 1))
    nodal, bubble = hexahedral_recovery.gradients(np.repeat(corners, 8, axis=0), local)
    strained = hexahedron.strain_matrix(nodal).reshape(count, 8, 6, 24)
    return law @ (
        strained
        + hexahedron.strain_matrix(bubble).reshape(count, 8, 6, 9)
        @ hexahedral_recovery.amplitudes(corners, law)[:, None]
    )
