"""Discretisation uncertainty of the rail compliance, from two meshes: the mesh of the compliance,
and the same with every edge divided into two.

At the border of a mount that clamps a part of a face, the stress is singular with the power -1/2 of
the distance. So the compliance C(h) converges with the first power of the element size h::

    C(h) = C(0) - a h,    C(0) - C(h) = 2 (C(h/2) - C(h)),    U = 1.25 |C(0) - C(h)| / C(h)

where 1.25 covers higher powers. Hexahedra keep the plane facets of a curved wall, so U does not
include its curvature. The polygon of a fillet in the built-in section is kept too; its area is
exact. On joints and with a fillet C(h) converges with the second power, and U is too large.

A coarser mesh cannot be the second one: walls one element thick keep one element, and the change
shows less than half of the error. The finer mesh is solved for few loads, by conjugate gradients.
The preconditioner is the solution on the mesh itself plus the diagonal of the finer stiffness. The
compliance f'x + x'(f - K x) is then below the exact one only by the squared energy norm of the
error. Elements that are many times as long as a wall is thick make it converge slowly: the finer ones
follow the bending of a wall that the others do not. As soon as the iteration is expected to take as
long again as the factor of a slender rail on the finer mesh (``statics.chain``), that takes its place.

Sources: Roache, J. Fluids Eng. 116 (1994) 405, the factor of a known order; Strang and Fix, An
Analysis of the Finite Element Method, 1973, chapter 8, the rate at singular points; Saad, Iterative
Methods for Sparse Linear Systems, 2003, chapter 9.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array

from tipoff.highfi import compliance
from tipoff.highfi.mesh import split
from tipoff.highfi.mesh.cells import edge_lengths
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.rail import inputs
from tipoff.highfi.rail.places import Patches, one_of, reported
from tipoff.highfi.simulation import prepare
from tipoff.highfi.statics import assembly, chain
from tipoff.highfi.statics.held import HeldRail
from tipoff.highfi.statics.operator import internal_force
from tipoff.highfi.statics.slabs import Slabs
from tipoff.highfi.statics.solve import Clamped, one_thread
from tipoff.mechanics.model import Faces, half_sizes
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.rail import MeshTable
from tipoff.scenes.scene import Scene

SAFETY_FACTOR = 1.25
_PLACES = 4  # along the way of the pads
_SOLUTIONS = 12  # about as many for each load, of the iteration and the modes
# Parts of the work whose progress is reported
ITERATION, DIRECTLY = "uncertainty", "uncertainty, directly"
_MODES = 3  # close modes may change places; the lowest is then still among them
MOST_BYTES = 4e9  # on the finer mesh
_ROWS = 6  # of each load, in the iteration
_ACCURACY = 1e-4  # of the compliance, in the norm of the preconditioner
_MOST_ITERATIONS = 500
_PILOTS = 4  # loads of which the iteration is tried before that of many more
_MANY = 8 * _PILOTS
_TRIED = 5  # iterations before their number is estimated
_SMOOTHING = 0.5  # share of the diagonal in the preconditioner
_ITERATION = 3e-7  # s for each element and load, on an AMD EPYC at 2.6 GHz as those of ``chain``


class Uncertainty(NamedTuple):
    """Relative uncertainties; None for the reason ``why``."""

    compliance: np.ndarray | None  # (f,) of each face, its mean along the way of the pads
    frequency: float | None  # lowest of all rails
    why: str = ""

    def stated(self) -> dict[str, Any]:
        """Fields of a ``RailCompliance``."""
        return {
            "uncertainty": self.compliance,
            "frequency_uncertainty": self.frequency,
            "not_known": self.why,
        }


def stated(
    scene: Scene,
    element_size: float,
    found: RailCompliance,
    rails: Sequence[HeldRail] | None = None,
) -> RailCompliance:
    """``found`` with the size (m) of its elements and their uncertainty. ``compliance.condense``
    made it for ``scene`` and ``element_size`` (m); ``rails`` are those that it used. Raises
    SceneError or MeshError."""
    known = of_scene(scene, element_size, rails)
    return replace(found, element_size=size_of(scene, element_size), **known.stated())


def size_of(scene: Scene, element_size: float) -> float:
    """Size (m) of the elements, those of a file if the rail is from one. Raises SceneError or MeshError."""
    if not isinstance(scene.rail, MeshTable):
        return element_size
    mesh = prepare(inputs.nominal(scene), Numerics(element_size=element_size))
    return split.shortest(mesh)


def of_scene(
    scene: Scene, element_size: float, rails: Sequence[HeldRail] | None = None
) -> Uncertainty:
    """Uncertainty of ``compliance.condense`` in elements of ``element_size`` (m), with the same
    ``rails``. Raises SceneError or MeshError."""
    scene = inputs.nominal(scene)
    own = inputs.of_scene(scene)
    way = own.reach[1] - own.faces.half_length - own.faces.centre[:, 0]
    travel = np.linspace(0.0, way.max(), _PLACES)
    return of_rails(rails or compliance.rails(scene, element_size), own.faces, own.reach, travel)


def of_rails(
    rails: Sequence[HeldRail],
    faces: Faces,
    reach: tuple[float, float],
    travel: np.ndarray,
) -> Uncertainty:
    """Uncertainty of ``compliance.of_rails``. Raises MeshError as it does."""
    half = half_sizes(faces)
    coarse, fine = (np.zeros((travel.size, faces.axis.size)) for _ in range(2))
    lowest: list[tuple[float, float]] = []
    for before, held in enumerate(rails):
        own = Patches(held.rail, 1)
        numbers = [[own.under(faces, half, signs, reach, travel) for signs in held.images]]
        if not own.found:
            continue
        if _bytes(held, len(own.found)) > MOST_BYTES:
            many = f"elements of half the size: {8 * len(held.rail.cells):,} on a rail, too many"
            return Uncertainty(None, None, many)
        finer, weights = split.refined(held.rail)
        other = Patches(finer, 1)
        numbers.append([other.under(faces, half, signs, reach, travel) for signs in held.images])
        with one_of(before, len(rails)):
            made = _pair(held, finer, weights, (own.loads(), other.loads()))
        if made is None:
            return Uncertainty(None, None, _not_solved(held.rail))
        for sums, values, places in zip((coarse, fine), made.compliance, numbers):
            padded = np.append(values, 0.0)  # number -1: no wall
            for number in places:
                sums += padded[number]
        lowest.append(made.frequency)
    if not lowest:
        return Uncertainty(None, None, "no pad is over a wall")
    change = np.abs(fine - coarse).sum(axis=0)
    total = coarse.sum(axis=0)
    relative = np.divide(change, total, out=np.zeros_like(total), where=total > 0.0)
    coarsest, finest = min(lowest)
    return Uncertainty(
        2.0 * SAFETY_FACTOR * relative, 2.0 * SAFETY_FACTOR * abs(finest / coarsest - 1.0)
    )


class _Pair(NamedTuple):
    """Values on a mesh, and on the finer one."""

    compliance: tuple[np.ndarray, np.ndarray]  # (l,) m/N of each load under itself
    frequency: tuple[float, float]  # rad/s, the lowest


def _not_solved(rail: RailMesh) -> str:
    lengths = edge_lengths(rail.points, rail.cells)
    ratio = float(np.median(lengths.max(axis=1) / lengths.min(axis=1)))
    return (
        "no convergence of the solution with elements of half the size; the elements are "
        f"{ratio:.0f} times as long as thick, and shorter ones (studies.element_size) converge sooner"
    )


def _bytes(held: HeldRail, loads: int) -> float:
    """About the memory on the finer mesh: matrices of elements, of which each has at most eight
    shapes, and rows of all degrees of freedom."""
    return 8.0 * (
        8 * held.operator.stiffness.size + _ROWS * (loads + _MODES) * 24 * len(held.rail.points)
    )


def _pair(
    rail: HeldRail, finer: RailMesh, weights: csr_array, loads: tuple[csc_array, csc_array]
) -> _Pair | None:
    """Both solutions; None if the iteration on the finer mesh does not converge and a factor would
    take longer."""
    held = rail.clamped(_SOLUTIONS * (loads[0].shape[1] + _MODES))
    own_load = loads[0][held.free].toarray()
    own = (own_load * held.solve(own_load)).sum(axis=0)
    frequency, shape = rail.modes(_MODES)
    operator = assembly.of_material(finer, rail.material, joint=rail.joint)
    fine = _Finer(operator, weights, held)
    pressed = fine.held_still(loads[1].toarray().T)
    swung = fine.mass * fine.interpolated(shape.T)
    every, count = np.concatenate([pressed, swung]), len(pressed)
    most = _iterations(held, finer, len(every))
    may_factor = most <= _MOST_ITERATIONS
    limit = min(most, _MOST_ITERATIONS)
    # rows of all loads of a long rail take 1 GB, mostly to find that they do not converge
    pilots = every[:: len(every) // _PILOTS] if may_factor and len(every) >= _MANY else every[:0]
    solved = _solved(fine, pilots, limit, may_factor)
    if solved is not None:
        solved = _solved(fine, every, limit, may_factor)
    if solved is None:
        if not may_factor:
            return None
        products = _factored(operator, every)
        # the modes on the mesh itself are nearly those on the finer one: Ritz values of the inverse
        swing = fine.interpolated(shape.T)
        shares = eigh(products[count:, count:], swing @ (fine.mass * swing).T, eigvals_only=True)
        finest = np.diag(products)[:count]
        return _Pair((own, finest), (float(frequency[0]), float(1.0 / np.sqrt(shares[-1]))))
    moved, rest = solved
    finest = (moved[:count] * (pressed + rest[:count])).sum(axis=1)
    basis = moved[count:]
    squares = eigh(basis @ fine.force(basis).T, basis @ (fine.mass * basis).T, eigvals_only=True)
    return _Pair((own, finest), (float(frequency[0]), float(np.sqrt(squares[0]))))


def _iterations(held: Clamped, finer: RailMesh, loads: int) -> int:
    """Iterations for so many ``loads`` that take as long as a factor on the ``finer`` mesh; more than
    ``_MOST_ITERATIONS`` if there is no memory for one."""
    elements = len(finer.cells)
    count = 2 * len(chain.layers(csr_array(held.stiffness)))
    width = 3.0 * len(finer.points) / count
    if 64.0 * width**2 > MOST_BYTES:
        return _MOST_ITERATIONS + 1
    return math.ceil(chain.seconds(count, width) / (_ITERATION * elements * loads))


def _factored(operator: assembly.Operator, loads: np.ndarray) -> np.ndarray:
    """Displacement (l,l) of each of the ``loads`` (l,3n) under each, by layers of the whole mesh."""
    report = reported()
    with one_thread():
        return Slabs(operator).products(loads.T, lambda done: report(done, DIRECTLY))


class _Finer:
    """Statics of the finer mesh with all its 3n degrees of freedom; rows are loads or displacements.
    The stiffness is not assembled: that would take longer than all products with it."""

    def __init__(self, operator: assembly.Operator, weights: csr_array, coarse: Clamped):
        self._operator, self._coarse = operator, coarse
        self._weights, self._sums = weights, csr_array(weights.T)
        self._fixed = np.flatnonzero(np.repeat(~operator.free, 3))
        self._share = _SMOOTHING / self._diagonal()
        self.mass = np.repeat(operator.mass, 3)

    def _diagonal(self) -> np.ndarray:
        own = self._operator
        shares = np.einsum("cii->ci", own.stiffness)[own.shape_class]
        freedoms = 3 * own.cells[:, :, None].astype(np.int64) + np.arange(3)
        found = np.bincount(freedoms.ravel(), shares.ravel(), minlength=3 * len(own.mass))
        return found if own.joints is None else found + own.joints.diagonal()

    def held_still(self, rows: np.ndarray) -> np.ndarray:
        """``rows`` with zeros for the fixed degrees of freedom, in place."""
        rows[:, self._fixed] = 0.0
        return rows

    def force(self, moved: np.ndarray) -> np.ndarray:
        """Force (l,3n) N of displacements (l,3n) m."""
        own, found = self._operator, np.empty_like(moved)
        for row, out in zip(moved, found):
            internal_force(
                row.reshape(-1, 3), own.cells, own.shape_class, own.stiffness, out.reshape(-1, 3)
            )
            if own.joints is not None:
                out += own.joints @ row
        return self.held_still(found)

    def interpolated(self, moved: np.ndarray) -> np.ndarray:
        """Displacements (l,3n) of those (l,d) of the free degrees of freedom of the coarse mesh."""
        whole = np.zeros(self._coarse.free.size)
        found = np.empty((len(moved), self.mass.size))
        for row, out in zip(moved, found):
            whole[self._coarse.free] = row
            out[:] = (self._weights @ whole.reshape(-1, 3)).ravel()
        return self.held_still(found)

    def nearly_solved(self, residual: np.ndarray) -> np.ndarray:
        """The preconditioner: displacements (l,3n) m that nearly have the forces ``residual``
        (l,3n)."""
        summed = np.empty((self._coarse.stiffness.shape[0], len(residual)))
        for number, row in enumerate(residual):
            summed[:, number] = (self._sums @ row.reshape(-1, 3)).ravel()[self._coarse.free]
        found = self.interpolated(self._coarse.solve(summed).T)
        for row, out in zip(residual, found):
            out += self._share * row
        return found


def _solved(
    fine: _Finer, loads: np.ndarray, most: int, ends_early: bool
) -> tuple[np.ndarray, np.ndarray] | None:
    """Displacement (l,3n) under ``loads`` (l,3n) and its residual (l,3n), by conjugate gradients for
    all loads; None if they do not converge in ``most`` iterations, or, if it ``ends_early``, if so many
    more are expected to be left."""
    moved, rest = np.zeros_like(loads), loads.copy()
    towards = np.zeros_like(loads)
    before, report, nearest = np.ones(len(loads)), reported(), 0.0
    with one_thread():
        for done in range(most):
            better = fine.nearly_solved(rest)
            now = _products(rest, better)
            least = np.abs(_products(loads, moved))
            if (now <= _ACCURACY * least).all():
                return moved, rest
            if (known := least > 0.0).any():
                far = max(float((now[known] / least[known]).max()), _ACCURACY)
                nearest = max(nearest, min(math.log(far) / math.log(_ACCURACY), 1.0))
                report(nearest, ITERATION)
                if ends_early and done >= _TRIED and done * (1.0 - nearest) > most * nearest:
                    return None
            towards *= _ratio(now, before)[:, None]
            towards += better
            pulled = fine.force(towards)
            length = _ratio(now, _products(towards, pulled))[:, None]
            moved += length * towards
            rest -= length * pulled
            before = now
    return None


def _ratio(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Ratio (l,), zero for a load of zeros, as of a face over fixed nodes only: nothing moves."""
    return np.divide(part, whole, out=np.zeros_like(part), where=whole != 0.0)


def _products(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Scalar product (l,) of each row."""
    return np.einsum("lk,lk->l", first, second)
