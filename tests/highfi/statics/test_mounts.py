"""Rails on joints of finite stiffness: resultants, the rigid limit, thermal displacement, and the
deflection and frequencies of other elements."""

from dataclasses import replace

import numpy as np
import pytest

from tests.highfi.blocks import ALUMINIUM, block
from tests.highfi.statics import loaded_rail
from tests.highfi.statics import quadratic_rail as other
from tests.highfi.statics.loaded_rail import MATERIAL, solved
from tests.highfi.tets import split
from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.statics import assembly, mounts, thermal
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.mechanics.laws.thermal import FIELDS, Thermal
from tipoff.scenes.rail_base import MaterialTable

SIZE = (0.06, 0.02, 0.01)  # m
SOFT = MountStiffness(normal=2e11, shear=1e11)


def rotation_about(axis, points, centre):
    return np.cross(np.eye(3)[axis], points - centre)


@pytest.mark.parametrize("kind", ["hexahedra", "tetrahedra"])
def test_force_and_moment_of_a_strip_that_moves_as_a_rigid_body(kind):
    """A k_n along the normal, A k_t across it; tilted about an axis in its plane w^3 l k_n / 12.
    Control: lumped at the nodes, one element across would resist the tilt three times as much."""
    mesh = block((3, 1, 1), SIZE) if kind == "hexahedra" else split(block((3, 1, 1), SIZE))
    matrix = mounts.stiffness(mesh.points, mesh.surfaces["mount"], SOFT)
    _, width, height = SIZE
    centre = np.array([0.0, 0.5 * width, 0.5 * height])
    moves = [np.tile(row, (len(mesh.points), 1)) for row in np.eye(3)]
    moves += [rotation_about(axis, mesh.points, centre) for axis in range(3)]
    energy = [move.ravel() @ (matrix @ move.ravel()) for move in moves]
    polar = width * height * (width**2 + height**2) / 12.0
    exact = [
        SOFT.normal * width * height,
        SOFT.shear * width * height,
        SOFT.shear * width * height,
        SOFT.shear * polar,
        SOFT.normal * width * height**3 / 12.0,
        SOFT.normal * height * width**3 / 12.0,
    ]
    assert energy == pytest.approx(exact, rel=1e-12)
    assert abs(matrix - matrix.T).max() <= 1e-12 * abs(matrix).max()
    if kind == "hexahedra":
        lumped = np.asarray(matrix.sum(axis=1)).ravel()
        assert (lumped * moves[4].ravel() ** 2).sum() == pytest.approx(3.0 * exact[4], rel=1e-12)


@pytest.fixture(scope="module")
def rail():
    """One L rail of the catalogue, elements of 2 mm."""
    return loaded_rail.rail(2e-3)


def extrapolated(joint):
    """The other elements at 8 and 4 mm, linearly to zero: the sharp inner corner and the edge of a
    rigid strip converge with the first power of the size."""
    coarse, fine = (other.solve(size, MATERIAL, joint) for size in (8e-3, 4e-3))
    return other.Solution(
        2.0 * fine.deflection - coarse.deflection, 2.0 * fine.frequencies - coarse.frequencies
    )


# ``extrapolated(SOFT)``, which takes six seconds and is compared with it in a slow test.
ON_SOFT_MOUNTS = other.Solution(
    6.209817756e-05, np.array([565.999920, 1350.365896, 2530.645687, 3188.838094])
)


@pytest.mark.slow
def test_kept_values_are_those_of_quadratic_hexahedra():
    exact = extrapolated(SOFT)
    assert ON_SOFT_MOUNTS.deflection == pytest.approx(exact.deflection, rel=1e-8)
    assert ON_SOFT_MOUNTS.frequencies == pytest.approx(exact.frequencies, rel=1e-8)


@pytest.mark.case("O53")
def test_soft_mounts_against_quadratic_hexahedra(rail):
    """Where the joints carry most of the deflection, it and the first four frequencies are within
    1 % at 2 mm. Control: a twentieth more stiffness is not."""
    exact, (deflection, frequencies, _) = ON_SOFT_MOUNTS, solved(rail, SOFT)
    assert deflection == pytest.approx(exact.deflection, rel=0.01)
    assert frequencies == pytest.approx(exact.frequencies, rel=0.01)
    stiffer = solved(rail, MountStiffness(*(1.05 * part for part in SOFT)))
    assert stiffer.deflection < 0.98 * exact.deflection


@pytest.mark.case("O53")
@pytest.mark.slow
def test_rigid_mounts_converge_slowly(rail):
    """At the edges of rigid strips every mesh does: at 2 mm they are further from the quadratic
    elements than soft ones are."""
    exact, (deflection, frequencies, _) = extrapolated(None), solved(rail, None)
    assert deflection < 0.97 * exact.deflection
    assert frequencies.max() > 1.01 * exact.frequencies.max()


def test_the_limit_of_stiff_joints_is_the_rigid_mount():
    """Deflection and frequencies approach those of rigid mounts with the compliance of the joints,
    1 / k."""
    rail = loaded_rail.rail(8e-3)
    rigid = solved(rail, None)
    found = [solved(rail, MountStiffness(k, 0.5 * k)) for k in (1e17, 1e16)]
    little, more = (each.deflection - rigid.deflection for each in found)
    assert 0.0 < little < 1e-3 * rigid.deflection
    assert more / little == pytest.approx(10.0, rel=0.02)
    assert found[0].frequencies == pytest.approx(rigid.frequencies, rel=1e-3)
    assert (found[0].frequencies < rigid.frequencies).all()


def test_a_bar_that_expands_between_two_joints():
    """The force is alpha T A / (1/E + 2 / (k l)) with Poisson's ratio zero; what the mounts moved
    by the platform's strain alpha T hold has no stress."""
    expansion, warmer, modulus = 23.6e-6, 20.0, 72e9
    length, width, height = SIZE
    bar = block((12, 2, 2), SIZE)
    facets = bar.surfaces["mount"]
    end = facets + (np.flatnonzero(bar.points[:, 0] > length - 1e-9)[0])
    assert (bar.points[end][..., 0] == length).all()
    bar = replace(bar, surfaces={"mount": np.concatenate([facets, end])})
    material = MaterialTable.model_validate(
        {"density": 1.0, "youngs_modulus": modulus, "poisson_ratio": 0.0},
        context={"bare_numbers_are_si": True},
    )
    joint = MountStiffness(2e12, 1.0)
    amounts = np.zeros(FIELDS)
    amounts[0] = expansion * warmer
    moved = thermal.displacement(bar, material, Thermal(amounts, 0.5 * length), joint)
    stress = expansion * warmer / (1.0 / modulus + 2.0 / (joint.normal * length))
    assert moved[bar.points[:, 0] == length, 0] == pytest.approx(stress / joint.normal, rel=1e-9)
    amounts[-1] = amounts[0]
    joint = MountStiffness(2e12, 1e12)
    free = thermal.displacement(
        replace(bar, points=bar.points - [0.0, 0.5 * width, 0.5 * height]),
        material,
        Thermal(amounts, 0.5 * length),
        joint,
    )
    exact = amounts[0] * (bar.points - [0.5 * length, 0.5 * width, 0.5 * height])
    assert np.abs(free - exact).max() <= 1e-9 * np.abs(exact).max()


def test_a_rail_without_mounts_is_refused():
    bar = replace(block((2, 1, 1), SIZE), surfaces={"mount": np.zeros((0, 4), dtype=np.int64)})
    with pytest.raises(MeshError, match="no mount"):
        Clamped(assembly.build(bar, **ALUMINIUM, joint=SOFT))
