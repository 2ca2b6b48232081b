"""The L rail of the catalogue in quadratic hexahedra of scikit-fem, on mounts of its own boundary
form, with a sharp inner corner or with a fillet of curved elements. No code of the project is used
here.

Axes: x along the rail from its rear end, y and z inwards from the outer corner, all in metres.
"""

import itertools
from dataclasses import replace
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
from skfem.mesh import MeshHex2
from skfem.models.elasticity import lame_parameters, linear_elasticity, linear_stress

LEG, THICKNESS, LENGTH, STRIP = 0.024, 0.004, 0.220, 0.004
SPANS = ((0.008, 0.028), (0.100, 0.120), (0.192, 0.212))
PATCH_X, PATCH_Z = (0.056, 0.072), (0.004, 0.020)  # on the inner wall that faces along y
BESIDE_FILLET = (0.006, 0.022)  # the patch of a rail with a fillet
FORCE = 100.0  # N
_POINTS = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 5)] * 2)).reshape(2, -1)  # of a facet


class Solution(NamedTuple):
    """Mean deflection (m) of the patch under FORCE, the first four frequencies (4,) Hz, and the
    largest von Mises stress (Pa) on the fillet beside the middle of the patch, NaN without one."""

    deflection: float
    frequencies: np.ndarray
    stress: float = np.nan


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


def _mesh(size: float, along: float, patch: tuple[float, float], fillet: float) -> MeshHex:
    stations = sorted({0.0, LENGTH, *PATCH_X, *(border for span in SPANS for border in span)})
    borders = sorted({0.0, THICKNESS, THICKNESS + fillet, *patch, LEG})
    depths = _lines(*borders, size=size)
    whole = MeshHex.init_tensor(_lines(*stations, size=along), depths, depths)
    middle = whole.p[:, whole.t].mean(axis=1)
    return whole.restrict(np.flatnonzero(middle[1:].min(axis=0) < THICKNESS))


def _curved(mesh: MeshHex, radius: float) -> MeshHex2:
    """All nodes on the wall of the fillet, also those between corners, are on its arc; the lines from
    the back to them are straight."""
    curved = MeshHex2.from_mesh(mesh)
    points = curved.doflocs.copy()
    first = points[1] >= points[2]
    for long, short, larger in ((1, 2, first), (2, 1, ~first)):
        chosen = larger & (points[long] < THICKNESS + radius)
        a, b = curved.doflocs[long, chosen], curved.doflocs[short, chosen]
        angle = 0.25 * np.pi * np.clip(1.0 - (a - THICKNESS) / radius, 0.0, 1.0)
        share = np.minimum(a, THICKNESS) * b / THICKNESS**2
        centre = THICKNESS + radius
        points[long, chosen] += share * (centre - radius * np.sin(angle) - np.maximum(a, THICKNESS))
        points[short, chosen] += share * (radius - radius * np.cos(angle))
    return replace(curved, doflocs=points)


def _within(x, spans) -> np.ndarray:
    return np.any([(x > a) & (x < b) for a, b in spans], axis=0)


def _largest(basis: FacetBasis, moved: np.ndarray, constants: tuple[float, float]) -> float:
    """Largest von Mises stress (Pa) at the points of the facets in the middle of the patch."""
    gradient = basis.interpolate(moved).grad
    stress = linear_stress(*constants)(0.5 * (gradient + gradient.swapaxes(0, 1)))
    eye = np.eye(3)[:, :, None, None]
    deviator = stress - eye * np.trace(stress) / 3.0
    along = np.asarray(basis.global_coordinates())[0]
    inside = abs(along - np.mean(PATCH_X)) < 1e-9
    return float(np.sqrt(1.5 * (deviator**2).sum(axis=(0, 1)))[inside].max())


def solve(
    size: float,
    material: tuple[float, float, float],
    joint: tuple[float, float] | None,
    modes: int = 4,
    fillet: float = 0.0,
    along: float | None = None,
) -> Solution:
    """The rail in elements of about ``size`` (m), and ``along`` (m) along the rail, of a ``material``
    (density kg/m3, Young's modulus Pa, Poisson's ratio) on a ``joint`` (normal, shear stiffness
    N/m3), or on rigid mounts, with a ``fillet`` (m)."""
    density, modulus, ratio = material
    patch_z = BESIDE_FILLET if fillet else PATCH_Z
    flat, element = _mesh(size, along or size, patch_z, fillet), ElementVector(ElementHex2())
    mesh = _curved(flat, fillet) if fillet else flat
    basis = Basis(mesh, element, intorder=4)
    constants = lame_parameters(modulus, ratio)
    stiffness = linear_elasticity(*constants).assemble(basis)
    mass = _mass.assemble(basis, density=density)
    strip = flat.facets_satisfying(
        lambda x: _within(x[0], SPANS) & (x[1:].min(axis=0) < 1e-9) & (x[1:].max(axis=0) < STRIP),
        boundaries_only=True,
    )
    free = np.arange(basis.N)
    if joint is None:
        free = basis.complement_dofs(basis.get_dofs(strip))
    else:
        stiffness = stiffness + _joint.assemble(
            FacetBasis(flat, element, facets=strip, intorder=4), normal=joint[0], shear=joint[1]
        )
    patch = flat.facets_satisfying(
        lambda x: (
            (abs(x[1] - THICKNESS) < 1e-9) & _within(x[0], (PATCH_X,)) & _within(x[2], (patch_z,))
        ),
        boundaries_only=True,
    )
    area = (PATCH_X[1] - PATCH_X[0]) * (patch_z[1] - patch_z[0])
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
    moved = np.zeros(basis.N)
    moved[free] = FORCE * factor.solve(load)
    deflection, frequencies = float(load @ moved[free]), np.sqrt(np.sort(squares)) / (2.0 * np.pi)
    if not fillet:
        return Solution(deflection, frequencies)
    arc = flat.facets_satisfying(
        lambda x: (
            (abs(x[1:].min(axis=0) - THICKNESS) < 1e-9)
            & (x[1:].max(axis=0) < THICKNESS + fillet)
            & (abs(x[0] - np.mean(PATCH_X)) < (along or size))
        ),
        boundaries_only=True,
    )
    points = (_POINTS, np.full(_POINTS.shape[1], 1.0 / _POINTS.shape[1]))
    on_arc = FacetBasis(mesh, element, facets=arc, quadrature=points)
    return Solution(deflection, frequencies, _largest(on_arc, moved, constants))
