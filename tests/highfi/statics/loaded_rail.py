"""A built-in rail of the catalogue in the case of ``quadratic_rail``: a pressed patch between two
mounts, and the frequencies."""

from typing import NamedTuple

import numpy as np

from tests.highfi.statics import quadratic_rail as other
from tipoff.highfi.elements import hexahedral_recovery as recovery
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh, read
from tipoff.highfi.statics import assembly, vibration
from tipoff.highfi.statics.pressure import Wall
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.meshes import l_rail

MATERIAL = (2810.0, 72e9, 0.33)  # kg/m3, Pa, 1
GEOMETRY = l_rail.LRailGeometry()


class Rail(NamedTuple):
    """One L rail and the radius (m) of its fillet."""

    mesh: RailMesh
    fillet: float

    @property
    def patch(self) -> tuple[float, float]:
        """Z (m) of the pressed patch, from the outer corner."""
        return other.BESIDE_FILLET if self.fillet else other.PATCH_Z


def rail(size: float, fillet: float = 0.0) -> Rail:
    """One rail in elements of ``size`` (m)."""
    built = l_rail.build(GEOMETRY._replace(fillet=fillet), size)
    return Rail(pieces.pieces(read(built))[0], fillet)


def solved(own: Rail, joint: MountStiffness | None) -> other.Solution:
    """Deflection, frequencies and the stress in the inner corner on a ``joint`` or rigid mounts."""
    mesh, operator = own.mesh, assembly.build(own.mesh, *MATERIAL, joint=joint)
    held = Clamped(operator)
    x, z = np.mean(other.PATCH_X), np.mean(own.patch)
    outer = GEOMETRY.inner_corner_z + GEOMETRY.thickness
    wall = Wall(mesh.points, mesh.surfaces["contact_y"], 2)
    patch = wall.pressed(
        np.array([GEOMETRY.x_start + x, np.sign(mesh.points[0, 2]) * (outer - z)]),
        0.5 * np.array([np.ptp(other.PATCH_X), np.ptp(own.patch)]),
        1,
    )
    load = np.zeros((len(mesh.points), 3))
    np.add.at(load[:, 1], patch.node, patch.load[0])
    load = load.ravel()[held.free]
    frequencies, _ = vibration.modes(
        held.stiffness, np.repeat(operator.mass, 3)[held.free], held.solve, 4
    )
    moved = np.zeros(3 * len(mesh.points))
    moved[held.free] = other.FORCE * held.solve(load)
    return other.Solution(
        float(load @ moved[held.free]),
        frequencies / (2.0 * np.pi),
        _stress(own, moved.reshape(-1, 3)),
    )


def _stress(own: Rail, moved: np.ndarray) -> float:
    """Largest von Mises stress (Pa) in the inner corner beside the middle of the patch, of the mean
    over the elements at each node; NaN for a mesh without nodes there."""
    points, cells = own.mesh.points, own.mesh.cells
    outer = GEOMETRY.inner_corner_z + GEOMETRY.thickness
    inwards = outer - np.abs(points[:, 1:])
    near = abs(points[:, 0] - GEOMETRY.x_start - np.mean(other.PATCH_X)) < 1e-9
    near &= inwards.min(axis=1) > GEOMETRY.thickness - 1e-9
    near &= inwards.max(axis=1) < GEOMETRY.thickness + own.fillet + 1e-9
    if not near.any():
        return np.nan
    law = hexahedron.elasticity(*MATERIAL[1:])
    element, corner = np.nonzero(near[cells])
    strain = recovery.strain_matrix(points[cells[element]], law, recovery.NODES[corner])
    each = np.einsum("pij,pj->pi", strain, moved[cells[element]].reshape(len(element), -1)) @ law
    nodes, number = np.unique(cells[element, corner], return_inverse=True)
    total = np.zeros((len(nodes), 6))
    np.add.at(total, number, each)
    return float(recovery.von_mises(total / np.bincount(number)[:, None]).max())
