"""Stress recovered from displacement: constant on distorted meshes, linear through a bent wall,
Lame's in a cylinder."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from tests.exact import elasticity
from tests.highfi import cylinder
from tests.highfi.blocks import ALUMINIUM, block
from tests.highfi.elements.recovered import centre_strain, corner_matrix, strain
from tests.highfi.elements.test_beams import BEAM, ELASTIC, ROOT_STRESS, deflection
from tests.highfi.elements.test_hexahedron import (
    PATCH_GRADIENT,
    PATCH_HEXES,
    PATCH_INNER,
    PATCH_OUTER,
)
from tipoff.highfi.elements import hexahedral_recovery, hexahedron
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly

CORNERS = hexahedron.VTK_CORNERS.astype(float)


def at_corners(mesh, law, displacement):
    """Stress (e,8,6) Pa at the corners of the elements."""
    matrix = corner_matrix(mesh.points[mesh.cells], law)
    return (matrix @ displacement[mesh.cells].reshape(-1, 1, 24, 1))[..., 0]


def distorted():
    """Corners (4,8,3) of hexahedra no two edges of which are parallel."""
    return CORNERS + 0.15 * np.random.default_rng(3).uniform(-1.0, 1.0, (4, 8, 3))


@pytest.mark.case("O9")
def test_patch_has_constant_stress_at_every_corner():
    """2000 and 400, and hence a von Mises stress of 1200, at all eight corners of each distorted
    element."""
    points = np.concatenate([PATCH_OUTER, PATCH_INNER])
    mesh, law = RailMesh(points, PATCH_HEXES, {}), hexahedron.elasticity(1e6, 0.25)
    matrix, inner = (
        assembly.sparse(assembly.build(mesh, 1.0, 1e6, 0.25, fixed=())),
        np.arange(24, 48),
    )
    displacement = (points @ PATCH_GRADIENT.T).ravel()
    displacement[inner] = 0.0
    displacement[inner] = spsolve(matrix[inner][:, inner].tocsc(), -(matrix @ displacement)[inner])
    stress = at_corners(mesh, law, displacement.reshape(-1, 3))
    assert np.abs(stress - [2000.0, 2000.0, 2000.0, 400.0, 400.0, 400.0]).max() < 1e-10 * 2000.0
    assert hexahedral_recovery.von_mises(stress) == pytest.approx(1200.0, rel=1e-10)


def test_recovery_agrees_with_the_integration_points_of_the_element():
    """The formulas here and those that integrate the stiffness are written separately and must
    describe the same modes."""
    corners, law = distorted(), hexahedron.elasticity(72e9, 0.33)
    displacement = np.random.default_rng(4).standard_normal((4, 8, 3))
    places = hexahedron.basis(corners).X.T
    expected = hexahedron.gauss_strain(corners, law, displacement)
    for point, place in enumerate(places):
        found = strain(hexahedral_recovery, corners, law, np.tile(place, (4, 1)), displacement)
        assert found == pytest.approx(
            expected[:, point], rel=1e-11, abs=1e-12 * np.abs(expected).max()
        )
    centre = strain(
        hexahedral_recovery, corners, law, np.tile(hexahedral_recovery.CENTRE, (4, 1)), displacement
    )
    assert centre == pytest.approx(centre_strain(corners, displacement), rel=1e-12)


def test_corner_gradients_are_those_of_the_corner_matrix():
    corners, law = distorted(), hexahedron.elasticity(72e9, 0.33)
    displacement = np.random.default_rng(5).standard_normal((4, 8, 3))
    for corner in range(8):
        found = (
            strain(
                hexahedral_recovery, corners, law, np.tile(CORNERS[corner], (4, 1)), displacement
            )
            @ law
        )
        expected = (corner_matrix(corners, law)[:, corner] @ displacement.reshape(4, 24, 1))[..., 0]
        assert found == pytest.approx(expected, rel=1e-11, abs=1e-12 * np.abs(expected).max())


@pytest.mark.case("O6")
@pytest.mark.parametrize("divisions", [(60, 2, 1), (40, 2, 2), (40, 2, 4)])
def test_root_stress_in_the_outer_fibre(divisions):
    """7.5 MPa 6 P L / b h^2, read at the corners themselves and taken to the root along M(x), also
    with one element through the height.

    Control: at the centres, which the mean over an element sees, one element through the height
    shows nothing at all.
    """
    mesh, law = block(divisions, tuple(BEAM.values())), hexahedron.elasticity(**ELASTIC)
    operator = assembly.build(mesh, **ALUMINIUM, fixed=())
    _, displacement = deflection(mesh, operator)
    stress = at_corners(mesh, law, displacement)[..., 0]
    place = mesh.points[mesh.cells]
    # bending is constant in an element of that theory, and right at its middle
    middle = place[..., 0].mean(axis=1, keepdims=True)
    # St Venant: away from the held section
    near = (middle > 0.1 * BEAM["length"]) & (middle < 0.3 * BEAM["length"])
    top = near & np.isclose(place[..., 2], BEAM["height"])
    root = stress[top] / (1.0 - np.broadcast_to(middle, place.shape[:2])[top] / BEAM["length"])
    assert -root.mean() == pytest.approx(ROOT_STRESS, rel=1e-4)
    assert np.ptp(root) < 0.01 * ROOT_STRESS
    if divisions[2] == 1:
        centre = centre_strain(place, displacement[mesh.cells]) @ law
        assert np.abs(centre[:, 0]).max() < 0.01 * ROOT_STRESS


@pytest.mark.case("O11")
@pytest.mark.parametrize("poisson_ratio", [0.3, 0.49])
def test_stress_of_a_thick_cylinder(poisson_ratio):
    """Corner stresses, averaged over the elements that meet at a node, come to Lame's with the
    first order that a wall allows, where only elements of one side meet: 7 % of the largest stress
    on 24 elements through the wall."""
    law = hexahedron.elasticity(cylinder.MODULUS, poisson_ratio)
    errors = []
    for refinement in (3, 6):
        found = cylinder.solve(refinement, poisson_ratio)
        stress = at_corners(found.mesh, law, found.displacement)
        nodes = found.mesh.cells.ravel()
        mean = (
            np.stack([np.bincount(nodes, column) for column in stress.reshape(-1, 6).T], axis=1)
            / np.bincount(nodes)[:, None]
        )
        size = cylinder.INNER, cylinder.OUTER, cylinder.PRESSURE
        exact = elasticity.pressed_cylinder_stress(found.mesh.points, *size, poisson_ratio)
        assert (
            hexahedral_recovery.von_mises(exact)[found.radius < 3.0001].max()
            == hexahedral_recovery.von_mises(exact).max()
        )
        errors.append(np.abs(mean - exact).max() / np.abs(exact).max())
    assert errors[1] < 0.075
    assert np.log2(errors[0] / errors[1]) > 0.9
