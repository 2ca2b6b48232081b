"""The hexahedron: constant strain on distorted meshes, bending without locking, objectivity, and
what the law refuses."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from tests.exact import elasticity
from tests.highfi.blocks import ALUMINIUM, block, free_stiffness, modes, without_bubbles
from tests.highfi.elements.recovered import centre_strain
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh.rail_mesh import RailMesh, read
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.operator import internal_force
from tipoff.kernels import rotation
from tipoff.meshes import l_rail

# A 90 degree turn about (1, 1, 1): no axis of the mesh stays an axis.
TURN = rotation.matrices(np.array([[np.sqrt(0.5), *np.full(3, np.sqrt(0.5 / 3.0))]]))[0]

# MacNeal and Harder, Finite Elements in Analysis and Design 1 (1985) 3-20, figure 2.
PATCH_INNER = np.array(
    [
        [0.249, 0.342, 0.192],
        [0.826, 0.288, 0.288],
        [0.850, 0.649, 0.263],
        [0.273, 0.750, 0.230],
        [0.320, 0.186, 0.643],
        [0.677, 0.305, 0.683],
        [0.788, 0.693, 0.644],
        [0.165, 0.745, 0.702],
    ]
)
PATCH_OUTER = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    dtype=float,
)
PATCH_HEXES = np.array(
    [
        [8, 9, 10, 11, 12, 13, 14, 15],
        [0, 1, 2, 3, 8, 9, 10, 11],
        [12, 13, 14, 15, 4, 5, 6, 7],
        [0, 1, 9, 8, 4, 5, 13, 12],
        [11, 10, 2, 3, 15, 14, 6, 7],
        [0, 8, 11, 3, 4, 12, 15, 7],
        [9, 1, 2, 10, 13, 5, 6, 14],
    ]
)
PATCH_GRADIENT = 0.5e-3 * np.array([[2.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 1.0, 2.0]])


def force(operator, displacement):
    result = np.empty_like(displacement)
    internal_force(displacement, operator.cells, operator.shape_class, operator.stiffness, result)
    return result


@pytest.fixture(scope="module")
def rail():
    return read(l_rail.build(l_rail.LRailGeometry(), 0.004))


@pytest.mark.case("O9")
@pytest.mark.parametrize("turn", [np.eye(3), TURN], ids=["as published", "turned"])
def test_patch_has_constant_stress(turn):
    points = np.concatenate([PATCH_OUTER, PATCH_INNER])
    mesh = RailMesh(points @ turn.T, PATCH_HEXES, {})
    operator = assembly.build(mesh, 1.0, 1e6, 0.25, fixed=())
    matrix, inner = assembly.sparse(operator), np.arange(24, 48)
    displacement = (points @ PATCH_GRADIENT.T @ turn.T).ravel()
    displacement[inner] = 0.0
    displacement[inner] = spsolve(matrix[inner][:, inner].tocsc(), -(matrix @ displacement)[inner])
    law, corners = hexahedron.elasticity(1e6, 0.25), mesh.points[mesh.cells]
    nodal = displacement.reshape(-1, 3)[mesh.cells]
    gauss, centre = (
        hexahedron.gauss_strain(corners, law, nodal) @ law,
        centre_strain(corners, nodal) @ law,
    )
    for stress in (*np.moveaxis(gauss, 1, 0), centre):
        xx, yy, zz, xy, yz, zx = stress.T
        tensor = (
            turn.T @ np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]).transpose(2, 0, 1) @ turn
        )
        exact = np.full((3, 3), 400.0) + 1600.0 * np.eye(3)
        assert np.abs(tensor - exact).max() < 1e-10 * 2000.0


BEAM = {"length": 0.6, "width": 0.03, "height": 0.04}


def bending_frequencies(operator, count=3):
    """Those of the lowest modes that move mostly across the height."""
    frequencies, shapes = modes(operator, 8)
    part = (operator.mass[:, None] * shapes**2).sum(axis=1)
    return frequencies[part[:, 2] > 0.5 * part.sum(axis=1)][:count]


def beam(divisions=(40, 3, 4)):
    return block(divisions, tuple(BEAM.values()))


@pytest.mark.case("O7")
def test_cantilever_frequencies():
    exact = elasticity.timoshenko_cantilever(3, **BEAM, **ALUMINIUM)
    assert exact == pytest.approx([90.530, 555.602, 1507.433], abs=1e-3)
    assert bending_frequencies(assembly.build(beam(), **ALUMINIUM)) == pytest.approx(
        exact, rel=0.01
    )


@pytest.mark.case("O7")
def test_hexahedron_without_bubbles_locks():
    """Control: the same mesh without incompatible modes is 3.9 % off, four times what the case
    allows."""
    mesh = beam()
    operator = assembly.build(mesh, **ALUMINIUM)
    plain = without_bubbles(mesh, operator, ALUMINIUM["youngs_modulus"], ALUMINIUM["poisson_ratio"])
    exact = elasticity.timoshenko_cantilever(1, **BEAM, **ALUMINIUM)
    ratio = bending_frequencies(plain, 1) / exact
    assert ratio == pytest.approx(1.039, abs=0.002)


@pytest.mark.case("O12")
def test_turned_rail_has_turned_forces(rail):
    displacement = np.random.default_rng(1).standard_normal(rail.points.shape)
    turned = RailMesh(rail.points @ TURN.T, rail.cells, rail.surfaces)
    here, there = assembly.build(rail, **ALUMINIUM), assembly.build(turned, **ALUMINIUM)
    expected = force(here, displacement) @ TURN.T
    assert (
        np.abs(force(there, displacement @ TURN.T) - expected).max()
        < 1e-12 * np.abs(expected).max()
    )


@pytest.mark.case("O12")
def test_rigid_motion_stores_no_energy(rail):
    """In the frame that turns with the platform a rotation is no displacement. The small rotation
    that is left must store no energy."""
    operator = assembly.build(rail, **ALUMINIUM)
    rigid = np.array([0.3, -0.2, 0.5]) + np.cross([0.7, -0.4, 0.2], rail.points)
    strained = np.random.default_rng(2).standard_normal(rail.points.shape)
    strained *= np.linalg.norm(rigid) / np.linalg.norm(strained)
    reference = np.vdot(strained, force(operator, strained))
    assert abs(np.vdot(rigid, force(operator, rigid))) < 1e-14 * reference
    assert not force(operator, np.ones_like(rigid)).any()


@pytest.mark.case("O12")
def test_spinning_bar_stretches():
    mesh, rate = beam(), 20.0
    operator = assembly.build(mesh, **ALUMINIUM)
    stiffness, mass, free = free_stiffness(operator)
    pull = np.zeros(mesh.points.shape)
    pull[:, 0] = rate**2 * mesh.points[:, 0]
    displacement = np.zeros(free.size)
    displacement[free] = spsolve(stiffness.tocsc(), mass * pull.ravel()[free])
    end = mesh.points[:, 0] == BEAM["length"]
    exact = elasticity.spinning_bar_stretch(
        BEAM["length"], rate, ALUMINIUM["youngs_modulus"], ALUMINIUM["density"]
    )
    assert exact == pytest.approx(1.1240e-6, rel=1e-4)
    assert displacement.reshape(-1, 3)[end, 0].mean() == pytest.approx(exact, rel=0.01)


def test_operator_is_linear_and_symmetric_and_agrees_with_the_assembled_matrix(rail):
    operator = assembly.build(rail, **ALUMINIUM)
    first, second = np.random.default_rng(3).standard_normal((2, *rail.points.shape))
    one, other = force(operator, first), force(operator, second)
    scale = np.abs(one).max()
    assert (
        np.abs(force(operator, 2.0 * first + second) - 2.0 * one - other).max()
        < 1e-14 * 4.0 * scale
    )
    assert np.vdot(second, one) == pytest.approx(
        np.vdot(first, other), abs=1e-14 * scale * first.size
    )
    assert (
        np.abs((assembly.sparse(operator) @ first.ravel()).reshape(-1, 3) - one).max()
        < 1e-14 * scale
    )
    assert np.abs(one.sum(axis=0)).max() < 1e-12 * scale


def test_four_mirrored_rails_of_cubes_share_one_matrix(rail):
    operator = assembly.build(rail, **ALUMINIUM)
    assert operator.stiffness.shape == (1, 24, 24)
    assert operator.mass.sum() == pytest.approx(4.0 * 176e-6 * 0.220 * 2810.0, rel=1e-12)


@pytest.mark.case("X15")
@pytest.mark.parametrize("poisson_ratio", [0.5, 0.7, -1.0, float("nan")])
def test_impossible_material_is_refused(poisson_ratio):
    with pytest.raises(ValueError, match=str(poisson_ratio)):
        hexahedron.elasticity(72e9, poisson_ratio)


@pytest.mark.case("X15")
@pytest.mark.parametrize("poisson_ratio", [-0.99, 0.0, 0.499, 0.4999])
def test_possible_material_stores_energy(poisson_ratio):
    assert np.linalg.eigvalsh(hexahedron.elasticity(72e9, poisson_ratio))[0] > 0.0
