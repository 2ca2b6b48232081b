"""Stress recovered in ten-node tetrahedra: constant on distorted and curved meshes, linear through
a bent wall, worst node."""

import numpy as np
import pytest
from skfem import ElementTetP2
from skfem.quadrature import get_quadrature

from tests.highfi.blocks import ALUMINIUM
from tests.highfi.elements.recovered import strain
from tests.highfi.elements.test_beams import BEAM, ELASTIC, ROOT_STRESS, deflection
from tests.highfi.elements.test_hexahedron import PATCH_GRADIENT
from tests.highfi.elements.test_tetrahedron import EVEN, beam, bulged, patch, strained
from tipoff.highfi.elements import (
    hexahedral_recovery,
    hexahedron,
    tetrahedral_recovery,
    tetrahedron,
)
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly
from tipoff.highfi.stress import peaks
from tipoff.highfi.stress.peak import ROTATION, STRAIN, STRESS, no_peak

LAW = hexahedron.elasticity(72e9, 0.33)


def at_nodes(mesh, law, displacement):
    """Stress (e,10,6) Pa at the nodes of the elements, by the plain formulas."""
    nodes, local = (
        np.repeat(mesh.points[mesh.cells], 10, axis=0),
        np.tile(tetrahedral_recovery.NODES, (len(mesh.cells), 1)),
    )
    moved = np.repeat(displacement[mesh.cells], 10, axis=0)
    return strain(tetrahedral_recovery, nodes, law, local, moved).reshape(-1, 10, 6) @ law


def prepared(mesh, law=LAW):
    """Records with which the kernels examine ``mesh``, every element a class of its own."""
    classes = np.arange(len(mesh.cells), dtype=np.uint32)
    return peaks.build(mesh.points, mesh.cells, classes, law, np.arange(len(mesh.points)))


def found(mesh, displacement, law=LAW):
    """Peaks of ``mesh``."""
    peak, space = no_peak(), np.zeros(peaks.SIZE)
    peaks.find(
        np.asfortranarray(displacement), prepared(mesh, law), peak, space, 0, len(mesh.cells)
    )
    return peak


@pytest.mark.case("O9")
@pytest.mark.parametrize("curved", [False, True])
def test_patch_has_constant_stress_at_every_node(curved):
    """2000 and 400, and hence a von Mises stress of 1200, at all ten nodes of each element, by
    formulas and kernel."""
    mesh, inside = patch(curved)
    law = hexahedron.elasticity(1e6, 0.25)
    displacement = strained(
        mesh, inside, assembly.sparse(assembly.build(mesh, 1.0, 1e6, 0.25, fixed=()))
    )
    assert np.abs(at_nodes(mesh, law, displacement) - EVEN).max() < 1e-10 * 2000.0
    worst = found(mesh, displacement, law)
    assert law[3, 3] * np.sqrt(worst.square[STRESS]) == pytest.approx(1200.0, rel=1e-10)
    assert np.sqrt(worst.square[STRAIN]) == pytest.approx(np.linalg.norm(PATCH_GRADIENT), rel=1e-10)


def test_recovery_agrees_with_the_integration_points_of_the_element():
    mesh = bulged()
    displacement = np.random.default_rng(4).standard_normal(mesh.points.shape)[mesh.cells]
    nodes, places = mesh.points[mesh.cells], get_quadrature(ElementTetP2, 5)[0].T
    expected = np.einsum(
        "eqsd,ed->eqs", tetrahedron.kinematics(nodes).nodal, displacement.reshape(-1, 30)
    )
    for point, place in enumerate(places):
        found = strain(
            tetrahedral_recovery, nodes, LAW, np.tile(place, (len(nodes), 1)), displacement
        )
        assert found == pytest.approx(
            expected[:, point], rel=1e-11, abs=1e-12 * np.abs(expected).max()
        )


@pytest.mark.parametrize(
    "mesh", [pytest.param(beam((4, 1, 2)), id="straight"), pytest.param(bulged(), id="curved")]
)
def test_kernel_finds_the_worst_node_of_the_plain_formulas(mesh):
    displacement = 1e-6 * np.random.default_rng(5).standard_normal(mesh.points.shape)
    stress = hexahedral_recovery.von_mises(at_nodes(mesh, LAW, displacement))
    worst, place = found(mesh, displacement), np.unravel_index(stress.argmax(), stress.shape)
    assert LAW[3, 3] * np.sqrt(worst.square[STRESS]) == pytest.approx(stress.max(), rel=1e-11)
    assert tuple(worst.place[STRESS]) == place
    gradient = peaks.gradients(
        np.asfortranarray(displacement), prepared(mesh), np.zeros(peaks.SIZE), 0, len(mesh.cells)
    )
    slopes = tetrahedral_recovery.node_slopes(mesh.points[mesh.cells])
    _, along = tetrahedron.shape_functions(tetrahedral_recovery.NODES.T)
    expected = np.einsum("eai,ajq,eqjk->eqik", displacement[mesh.cells], along, slopes)
    assert np.abs(gradient - expected).max() < 1e-12 * np.abs(expected).max()
    even, odd = (
        0.5 * (expected + np.swapaxes(expected, 2, 3)),
        0.5 * (expected - np.swapaxes(expected, 2, 3)),
    )
    for what, norm in (
        (STRAIN, np.linalg.norm(even, axis=(2, 3))),
        (ROTATION, np.linalg.norm(odd, axis=(2, 3)) / np.sqrt(2.0)),
    ):
        assert np.sqrt(worst.square[what]) == pytest.approx(norm.max(), rel=1e-11)
        assert tuple(worst.place[what]) == np.unravel_index(norm.argmax(), norm.shape)


def test_a_translation_has_exactly_no_stress_and_a_turn_none_but_rounding():
    mesh, turn = bulged(), np.array([[0.0, -3.0, 2.0], [3.0, 0.0, -1.0], [-2.0, 1.0, 0.0]])
    still = found(mesh, np.ones_like(mesh.points) / 3.0)
    assert not still.square.any()
    turned = found(mesh, 1e-4 * mesh.points @ turn.T)
    assert np.sqrt(turned.square[ROTATION]) == pytest.approx(1e-4 * np.sqrt(14.0), rel=1e-10)
    assert np.sqrt(turned.square[STRAIN]) < 1e-10 * np.sqrt(turned.square[ROTATION])


@pytest.mark.parametrize("bulge", [0.0, 0.05, 0.1])
def test_the_middle_of_a_curved_edge_may_be_the_worst_node(bulge):
    """Under the displacement that strains the corners least. Control: between straight edges a
    corner stays the worst."""
    points = tetrahedral_recovery.NODES.copy()
    points[4] += [0.0, bulge, bulge]
    at_corners = tetrahedral_recovery.strain_matrix(
        np.tile(points, (4, 1, 1)), LAW, tetrahedral_recovery.NODES[:4]
    )
    # what comes after are the six rigid motions
    least = np.linalg.svd(at_corners.reshape(24, 30))[2][23]
    node = found(RailMesh(points, np.arange(10)[None], {}), least.reshape(10, 3)).place[STRESS, 1]
    assert node == 4 if bulge else node < 4


@pytest.mark.case("O6")
@pytest.mark.parametrize("divisions", [(40, 1, 1), (40, 2, 2)])
def test_root_stress_in_the_outer_fibre(divisions):
    """7.5 MPa 6 P L / b h^2, read at the nodes themselves and taken to the root along M(x), with
    one layer of cubes of six tetrahedra through the height: within 0.3 %."""
    mesh, law = beam(divisions), hexahedron.elasticity(**ELASTIC)
    _, displacement = deflection(mesh, assembly.build(mesh, **ALUMINIUM, fixed=()))
    stress, place = at_nodes(mesh, law, displacement)[..., 0], mesh.points[mesh.cells]
    x = place[..., 0]
    # St Venant: away from the held section
    near = (x > 0.1 * BEAM["length"]) & (x < 0.3 * BEAM["length"])
    top = near & np.isclose(place[..., 2], BEAM["height"])
    root = stress[top] / (1.0 - x[top] / BEAM["length"])
    assert -root.mean() == pytest.approx(ROOT_STRESS, rel=0.005)
    assert np.ptp(root) < 0.05 * ROOT_STRESS
