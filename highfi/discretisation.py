"""Discretisation uncertainty of the rail compliance, from two meshes: the mesh of the compliance,
and the same with every edge divided into two.

At the border of a mount that clamps a part of a face, the stress is singular with the power -1/2 of
the distance. So the compliance C(h) converges with the first power of the element size h::

    C(h) = C(0) - a h,    C(0) - C(h) = 2 (C(h/2) - C(h)),    U = 1.25 |C(0) - C(h)| / C(h)

where 1.25 covers higher powers. Hexahedra keep the plane facets of a curved wall, so U does not
include its curvature.

A coarser mesh cannot be the second one: walls one element thick keep one element, and the change
shows less than half of the error. The finer mesh is solved for few loads, by conjugate gradients.
The preconditioner is the solution on the mesh itself plus the diagonal of the finer stiffness. The
compliance f'x + x'(f - K x) is then below the exact one only by the squared energy norm of the
error.

Sources: Roache, J. Fluids Eng. 116 (1994) 405, the factor of a known order; Strang and Fix, An
Analysis of the Finite Element Method, 1973, chapter 8, the rate at singular points; Saad, Iterative
Methods for Sparse Linear Systems, 2003, chapter 9.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array, kron

from tipoff.highfi.compliance import nominal
from tipoff.highfi.mesh import pieces, split
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.run import prepare
from tipoff.highfi.statics import assembly, inputs, vibration
from tipoff.highfi.statics.places import Patches
from tipoff.highfi.statics.solve import Clamped, one_thread
from tipoff.mechanics import scene_model
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.mechanics.scene_model import Faces
from tipoff.scenes.effects.mount_stiffness import MountStiffness
from tipoff.scenes.rail import MaterialTable, MeshTable
from tipoff.scenes.scene import Scene

SAFETY_FACTOR = 1.25
_PLACES = 4  # along the way of the pads
_MODES = 3  # close modes may change places; the lowest is then still among them
MOST_ENTRIES = 1.5e8  # in the matrices of all elements: bounds memory and time
_CHUNK = 10_000  # elements assembled at once, for the same reason
_ACCURACY = 1e-4  # of the compliance, in the norm of the preconditioner
_MOST_ITERATIONS = 500
_SMOOTHING = 0.5  # share of the diagonal in the preconditioner


class Uncertainty(NamedTuple):
    """Relative uncertainties; None for the reason ``why``."""

    compliance: np.ndarray | None  # (f,) of each face, its mean along the way of the pads
    frequency: float | None  # lowest of all rails
    why: str = ""


def stated(scene: Scene, element_size: float, found: RailCompliance) -> RailCompliance:
    """``found`` with the size (m) of its elements and their uncertainty. ``compliance.condense``
    made it for ``scene`` and ``element_size`` (m). Raises SceneError or MeshError."""
    mesh = prepare(nominal(scene), Numerics(element_size=element_size))
    size = split.shortest(mesh) if isinstance(scene.rail, MeshTable) else element_size
    known = of(scene, element_size)
    return replace(
        found,
        element_size=size,
        uncertainty=known.compliance,
        frequency_uncertainty=known.frequency,
        not_known=known.why,
    )


def of(scene: Scene, element_size: float) -> Uncertainty:
    """Uncertainty of ``compliance.condense`` in elements of ``element_size`` (m). Raises SceneError or
    MeshError."""
    scene = nominal(scene)
    own = inputs.of(scene)
    mesh = prepare(scene, Numerics(element_size=element_size))
    way = own.reach[1] - own.faces.half_length - own.faces.centre[:, 0]
    travel = np.linspace(0.0, way.max(), _PLACES)
    return of_mesh(mesh, own.material, own.faces, own.reach, travel, own.joint)


def of_mesh(
    mesh: RailMesh,
    material: MaterialTable,
    faces: Faces,
    reach: tuple[float, float],
    travel: np.ndarray,
    joint: MountStiffness | None = None,
) -> Uncertainty:
    """Uncertainty of ``compliance.of_mesh``. Raises MeshError as it does."""
    half = scene_model.half_sizes(faces)
    coarse, fine = (np.zeros((travel.size, faces.axis.size)) for _ in range(2))
    lowest: list[tuple[float, float]] = []
    for rail, images in pieces.distinct(mesh):
        elements = 8 * len(rail.cells)
        if elements * (3 * rail.cells.shape[1]) ** 2 > MOST_ENTRIES:
            return Uncertainty(
                None, None, f"elements of half the size: {elements:,} on a rail, too many"
            )
        finer, weights = split.refined(rail)
        both = Patches(rail, 1), Patches(finer, 1)
        numbers = [
            [patches.under(faces, half, signs, reach, travel) for signs in images]
            for patches in both
        ]
        if not both[0].found:
            continue
        made = _pair(rail, finer, weights, (both[0].loads(), both[1].loads()), material, joint)
        if made is None:
            return Uncertainty(
                None, None, "no convergence of the solution with elements of half the size"
            )
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


def _pair(
    rail: RailMesh,
    finer: RailMesh,
    weights: csr_array,
    loads: tuple[csc_array, csc_array],
    material: MaterialTable,
    joint: MountStiffness | None,
) -> _Pair | None:
    """Both solutions; None if the iteration on the finer mesh does not converge."""
    operator = assembly.of_material(rail, material, joint=joint)
    held = Clamped(operator)
    own_load = loads[0][held.free].toarray()
    own = (own_load * held.solve(own_load)).sum(axis=0)
    frequency, shape = vibration.modes(
        held.stiffness, np.repeat(operator.mass, 3)[held.free], held.solve, _MODES
    )
    fine = assembly.of_material(finer, material, joint=joint)
    free = np.repeat(fine.free, 3)
    stiffness = _assembled(fine)[free][:, free]
    between = csr_array(kron(weights, np.eye(3)))[free][:, held.free]
    share = _SMOOTHING / stiffness.diagonal()[:, None]

    def nearly(residual: np.ndarray) -> np.ndarray:
        return between @ held.solve(between.T @ residual) + share * residual

    mass = np.repeat(fine.mass, 3)[free]
    pressed = loads[1][free].toarray()
    swung = mass[:, None] * (between @ shape)
    solved = _solved(stiffness, np.concatenate([pressed, swung], axis=1), nearly)
    if solved is None:
        return None
    moved, rest = solved
    count = pressed.shape[1]
    compliance = (moved[:, :count] * (pressed + rest[:, :count])).sum(axis=0)
    basis = moved[:, count:]
    squares = eigh(
        basis.T @ (stiffness @ basis), basis.T @ (mass[:, None] * basis), eigvals_only=True
    )
    return _Pair((own, compliance), (float(frequency[0]), float(np.sqrt(squares[0]))))


def _assembled(operator: assembly.Operator) -> csr_array:
    """``assembly.sparse``, in chunks that bound the memory."""
    size = 3 * len(operator.mass)
    found = csr_array((size, size)) if operator.joints is None else operator.joints
    for start in range(0, len(operator.cells), _CHUNK):
        part = slice(start, start + _CHUNK)
        found = found + assembly.sparse(
            operator._replace(
                cells=operator.cells[part], shape_class=operator.shape_class[part], joints=None
            )
        )
    return csr_array(found)


def _solved(
    stiffness: csr_array, loads: np.ndarray, nearly: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray] | None:
    """Displacement (d,l) under ``loads`` (d,l) and its residual (d,l), by conjugate gradients for
    all loads; None if they do not converge. ``nearly`` is the preconditioner."""
    moved, rest = np.zeros_like(loads), loads.copy()
    towards = np.zeros_like(loads)
    before = np.ones(loads.shape[1])
    with one_thread():
        for iteration in range(_MOST_ITERATIONS):
            better = nearly(rest)
            now = (rest * better).sum(axis=0)
            if (now <= _ACCURACY * np.abs((loads * moved).sum(axis=0))).all():
                return moved, rest
            towards = better + (now / before if iteration else 0.0) * towards
            pulled = stiffness @ towards
            length = now / (towards * pulled).sum(axis=0)
            moved += length * towards
            rest -= length * pulled
            before = now
    return None
