"""The L rail of the catalogue in quadratic hexahedra of scikit-fem, on mounts of its own boundary
form. No code of the project is used here.

Axes: x along the rail from its rear end, y and z inwards from the outer corner, all in metres.
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import (
    Basis,
    BilinearForm,
    ElementHex2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
)
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

LEG, THICKNESS, LENGTH, STRIP = 0.024, 0.004, 0.220, 0.004
SPANS = ((0.008, 0.028), (0.100, 0.120), (0.192, 0.212))
PATCH_X, PATCH_Z = (0.056, 0.072), (0.004, 0.020)  # on the inner wall that faces along y
FORCE = 100.0  # N


class Solution(NamedTuple):
    """Mean deflection (m) of the patch under FORCE, and the first four frequencies (4,) Hz."""

    deflection: float
    frequencies: np.ndarray


@BilinearForm
def _mass(u, v, w):
    return w["density"] * dot(u, v)


@BilinearForm
def _joint(u, v, w):
    along, across = dot(u, w.n) * dot(v, w.n), dot(u, v)
    return w["shear"] * across + (w["normal"] - w["shear"]) * along


@LinearForm
def _pressure(v, w):
    return -v[1]


def _lines(*borders: float, size: float) -> np.ndarray:
    parts = [
        np.linspace(a, b, max(1, round((b - a) / size)) + 1)[:-1]
        for a, b in itertools.pairwise(borders)
    ]
    return np.append(np.concatenate(parts), borders[-1])


def _mesh(size: float) -> MeshHex:
    stations = sorted({0.0, LENGTH, *PATCH_X, *(border for span in SPANS for border in span)})
    depths = _lines(0.0, *PATCH_Z, LEG, size=size)
    whole = MeshHex.init_tensor(_lines(*stations, size=size), depths, depths)
    middle = whole.p[:, whole.t].mean(axis=1)
    return whole.restrict(np.flatnonzero(middle[1:].min(axis=0) < THICKNESS))


def _within(x, spans) -> np.ndarray:
    return np.any([(x > a) & (x < b) for a, b in spans], axis=0)


def solve(
    size: float,
    material: tuple[float, float, float],
    joint: tuple[float, float] | None,
    modes: int = 4,
) -> Solution:
    """The rail in elements of about ``size`` (m) of a ``material`` (density kg/m3, Young's modulus
    Pa, Poisson's ratio) on a ``joint`` (normal, shear stiffness N/m3), or on rigid mounts."""
    density, modulus, ratio = material
    mesh, element = _mesh(size), ElementVector(ElementHex2())
    basis = Basis(mesh, element, intorder=4)
    stiffness = linear_elasticity(*lame_parameters(modulus, ratio)).assemble(basis)
    mass = _mass.assemble(basis, density=density)
    strip = mesh.facets_satisfying(
        lambda x: _within(x[0], SPANS) & (x[1:].min(axis=0) < 1e-9) & (x[1:].max(axis=0) < STRIP),
        boundaries_only=True,
    )
    free = np.arange(basis.N)
    if joint is None:
        free = basis.complement_dofs(basis.get_dofs(strip))
    else:
        stiffness = stiffness + _joint.assemble(
            FacetBasis(mesh, element, facets=strip, intorder=4), normal=joint[0], shear=joint[1]
        )
    patch = mesh.facets_satisfying(
        lambda x: (
            (abs(x[1] - THICKNESS) < 1e-9) & _within(x[0], (PATCH_X,)) & _within(x[2], (PATCH_Z,))
        ),
        boundaries_only=True,
    )
    area = (PATCH_X[1] - PATCH_X[0]) * (PATCH_Z[1] - PATCH_Z[0])
    load = _pressure.assemble(FacetBasis(mesh, element, facets=patch, intorder=4))[free] / area
    inner, weight = stiffness[free][:, free].tocsc(), mass[free][:, free]
    factor = splu(
        inner,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    squares = eigsh(
        inner,
        modes,
        weight,
        sigma=0.0,
        OPinv=LinearOperator(inner.shape, matvec=factor.solve, dtype=float),
        return_eigenvectors=False,
    )
    return Solution(
        FORCE * float(load @ factor.solve(load)), np.sqrt(np.sort(squares)) / (2.0 * np.pi)
    )
