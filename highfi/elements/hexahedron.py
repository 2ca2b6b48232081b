"""Eight-node hexahedron with incompatible modes (QM6), small strain, isotropic Hooke's law.

The trilinear displacement is enriched by three quadratic bubbles per component, 4 X_i (1 - X_i) on
the unit cube, whose amplitudes a belong to the element alone and are eliminated from it:

    [K   L^T] [u]   [f]
    [L   H  ] [a] = [0]     ->     f = (K - L^T H^-1 L) u

Without them, bending causes parasitic shear: the frequency of one-layer beams is 4 % too high on
good meshes, and the error has no limit on flat ones. The bubbles' gradients are mapped with the
Jacobian J0 of the centre and scaled by det J0 / det J, so that they integrate to zero over any
shape: a constant stress does no work on them, and the patch test holds.

Strains and stresses are ordered xx, yy, zz, xy, yz, zx, shear strains in engineering measure.

Source: Taylor, Beresford, Wilson, Int. J. Numer. Methods Eng. 10 (1976) 1211-1219.
"""

from typing import NamedTuple

import numpy as np
from skfem import Basis, ElementHex1, MeshHex

# Corners of the unit cube in VTK order, and for each corner of a scikit-fem cell the VTK corner at
# the same place.
VTK_CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)
_SKFEM_TO_VTK = np.array(
    [np.flatnonzero((VTK_CORNERS == corner).all(axis=1))[0] for corner in ElementHex1.doflocs]
)
_CENTRE = np.full((3, 1), 0.5)
_GAUSS_ORDER = 3  # 2 x 2 x 2 points
# Rows of the strain, and for each shear strain the two displacement derivatives (component,
# direction) that it sums.
_SHEAR = ((3, 0, 1), (4, 1, 2), (5, 2, 0))


class Kinematics(NamedTuple):
    """Strain matrices at the quadrature points of c elements."""

    nodal: np.ndarray  # (c,q,6,24) 1/m, by corner displacement
    bubble: np.ndarray  # (c,q,6,9) 1/m, by bubble amplitude
    volume: np.ndarray  # (c,q) m3 of each point


def elasticity(youngs_modulus: float, poisson_ratio: float) -> np.ndarray:
    """Isotropic stiffness (6,6) in Pa.

    Raises ValueError unless youngs_modulus > 0 and -1 < poisson_ratio < 0.5, outside which the
    material would be unstable.
    """
    if not (youngs_modulus > 0.0 and np.isfinite(youngs_modulus)):
        raise ValueError(f"Young's modulus must be positive and finite, got {youngs_modulus!r} Pa")
    if not -1.0 < poisson_ratio < 0.5:
        raise ValueError(
            f"Poisson's ratio must lie between -1 and 0.5, both excluded, got {poisson_ratio!r}"
        )
    shear = youngs_modulus / (2.0 * (1.0 + poisson_ratio))
    lame = youngs_modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    normal = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    dilatation = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    return lame * np.outer(dilatation, dilatation) + shear * (np.eye(6) + normal)


def basis(corners: np.ndarray, **quadrature) -> Basis:
    """scikit-fem basis of c elements with corners (c,8,3) m in VTK order, without shared
    nodes."""
    nodes = np.arange(8 * len(corners)).reshape(-1, 8)
    mesh = MeshHex(corners.reshape(-1, 3).T.copy(), nodes[:, _SKFEM_TO_VTK].T.copy())
    return Basis(mesh, ElementHex1(), **(quadrature or {"intorder": _GAUSS_ORDER}))


def shape_functions(cells: Basis) -> np.ndarray:
    """Values (8,q) of the corner functions, VTK order."""
    values = np.empty((8, cells.X.shape[1]))
    for local, vtk in enumerate(_SKFEM_TO_VTK):
        values[vtk] = np.asarray(cells.basis[local][0])[0]
    return values


def kinematics(cells: Basis) -> Kinematics:
    """Strain matrices at the points of `cells`, see `basis`."""
    gradient = np.empty((*cells.dx.shape, 8, 3))
    for local, vtk in enumerate(_SKFEM_TO_VTK):
        gradient[:, :, vtk] = np.moveaxis(cells.basis[local][0].grad, 0, -1)
    mapping, points = cells.mapping, cells.X
    scale = mapping.detDF(_CENTRE) / mapping.detDF(points)
    bubble = np.einsum(
        "cq,iq,ijc->cqij", scale, 4.0 * (1.0 - 2.0 * points), mapping.invDF(_CENTRE)[..., 0]
    )
    return Kinematics(strain_matrix(gradient), strain_matrix(bubble), cells.dx)


def stiffness(corners: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Condensed stiffness (c,24,24) in N/m, degrees of freedom as corner * 3 + component.

    corners (c,8,3) m in VTK order; law (6,6) Pa from `elasticity`.
    """
    strain = kinematics(basis(corners))
    full = integral(strain.nodal, law, strain.nodal, strain.volume)
    coupling, own = bubble_blocks(strain, law)
    condensed = full - np.swapaxes(coupling, 1, 2) @ np.linalg.solve(own, coupling)
    # symmetric to the last bit, so that energy is exact
    return 0.5 * (condensed + np.swapaxes(condensed, 1, 2))


def expansion(corners: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Condensed loads (c,24,8) in N of a free strain that is one at each corner in turn: f - L^T
    H^-1 f_a, since it loads the bubbles too."""
    cells = basis(corners)
    strain, stress = kinematics(cells), law[:, :3].sum(axis=1)
    direct, own_load = (
        np.einsum(
            "cqsd,s,aq,cq->cda", part, stress, shape_functions(cells), strain.volume, optimize=True
        )
        for part in (strain.nodal, strain.bubble)
    )
    coupling, own = bubble_blocks(strain, law)
    return direct - np.swapaxes(coupling, 1, 2) @ np.linalg.solve(own, own_load)


def node_mass(corners: np.ndarray, density: float) -> np.ndarray:
    """Row sums (c,8) in kg of the consistent mass: density times the integral of each corner
    function."""
    cells = basis(corners)
    return density * np.einsum("aq,cq->ca", shape_functions(cells), cells.dx)


def gauss_strain(corners: np.ndarray, law: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Strain (c,8,6) at the Gauss points, bubbles included; displacement (c,8,3) m."""
    strain = kinematics(basis(corners))
    coupling, own = bubble_blocks(strain, law)
    nodal = displacement.reshape(-1, 24, 1)
    amplitude = -np.linalg.solve(own, coupling @ nodal)
    return (strain.nodal @ nodal[:, None] + strain.bubble @ amplitude[:, None])[..., 0]


def bubble_blocks(strain: Kinematics, law: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """L (c,9,24) and H (c,9,9) of the module docstring."""
    return (
        integral(strain.bubble, law, strain.nodal, strain.volume),
        integral(strain.bubble, law, strain.bubble, strain.volume),
    )


def integral(
    left: np.ndarray, law: np.ndarray, right: np.ndarray, volume: np.ndarray
) -> np.ndarray:
    """Integral (c,a,b) of left^T law right over each element, from strain matrices (c,q,6,a) and
    (c,q,6,b) and volume (c,q)."""
    weighted = volume[..., None, None] * (law @ right)
    return (np.swapaxes(left, 2, 3) @ weighted).sum(axis=1)


def strain_matrix(gradient: np.ndarray) -> np.ndarray:
    """Strain (...,6,3a) from the gradients (...,a,3) of a functions, each multiplying a
    displacement vector."""
    matrix = np.zeros((*gradient.shape[:-2], 6, gradient.shape[-2], 3))
    for axis in range(3):
        matrix[..., axis, :, axis] = gradient[..., axis]
    for row, first, second in _SHEAR:
        matrix[..., row, :, first] = gradient[..., second]
        matrix[..., row, :, second] = gradient[..., first]
    return matrix.reshape(*matrix.shape[:-2], -1)
