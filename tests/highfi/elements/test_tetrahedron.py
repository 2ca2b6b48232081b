"""The ten-node tetrahedron: constant strain on distorted and curved meshes, bending, mass, and the
step that it needs."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from tests.exact import elasticity
from tests.highfi import tets
from tests.highfi.blocks import ALUMINIUM, block, highest_mode
from tests.highfi.elements.test_beams import BEAM, ELASTIC, FORCE, deflection, free_frequencies
from tests.highfi.elements.test_hexahedron import PATCH_GRADIENT, bending_frequencies
from tipoff.highfi.elements import hexahedron, tetrahedron
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.statics import assembly, stable_step
from tipoff.highfi.statics.operator import internal_force

COARSE = (20, 1, 1)  # cubes of six tetrahedra, one layer across the beam


def beam(divisions=COARSE) -> RailMesh:
    return tets.split(block(divisions, tuple(BEAM.values())))


def patch(curved: bool) -> tuple[RailMesh, np.ndarray]:
    """A cube of 48 tetrahedra with its inner corner out of place, and optionally curved inner
    edges; and which nodes are inside."""
    mesh = tets.split(block((2, 2, 2), (1.0, 1.0, 1.0)))
    inside = np.setdiff1d(np.arange(len(mesh.points)), boundary_facets(mesh.cells))
    random, points = np.random.default_rng(5), mesh.points.copy()
    centre = np.flatnonzero((points == 0.5).all(axis=1))[0]
    points[centre] += [0.1, -0.07, 0.05]
    middles = mesh.cells[:, 4:].ravel()
    points[middles] = points[mesh.cells[:, tetrahedron.EDGES]].mean(axis=2).reshape(-1, 3)
    if curved:
        bend = np.setdiff1d(inside, [centre])
        points[bend] += 0.03 * random.standard_normal((len(bend), 3))
    return RailMesh(points, mesh.cells, {}), inside


def strained(mesh, inside, matrix):
    """Displacement (n,3) of the patch when its surface has a constant strain and its inner nodes
    are free."""
    displacement = (mesh.points @ PATCH_GRADIENT.T).ravel()
    free = (3 * inside[:, None] + np.arange(3)).ravel()
    displacement[free] = 0.0
    displacement[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ displacement)[free])
    return displacement.reshape(-1, 3)


def stress(mesh, inside, matrix):
    """Stress (e,q,6) of the patch so strained."""
    nodal = strained(mesh, inside, matrix)[mesh.cells].reshape(len(mesh.cells), 30)
    strain = tetrahedron.kinematics(mesh.points[mesh.cells]).nodal
    return np.einsum("eqsd,ed->eqs", strain, nodal) @ hexahedron.elasticity(1e6, 0.25)


EVEN = np.array([2000.0] * 3 + [400.0] * 3)


@pytest.mark.case("O9")
@pytest.mark.parametrize("curved", [False, True])
def test_patch_has_constant_stress(curved):
    mesh, inside = patch(curved)
    operator = assembly.build(mesh, 1.0, 1e6, 0.25, fixed=())
    assert tetrahedron.is_straight(mesh.points[mesh.cells]).all() != curved
    assert np.abs(stress(mesh, inside, assembly.sparse(operator)) - EVEN).max() < 1e-10 * 2000.0


@pytest.mark.case("O9")
def test_four_points_fail_the_patch_test_between_curved_edges():
    """Control: with the rule that is exact for straight edges, inner nodes of a curved patch are
    displaced."""
    mesh, inside = patch(curved=True)
    strain = tetrahedron.kinematics(mesh.points[mesh.cells], 2)
    law = hexahedron.elasticity(1e6, 0.25)
    few = np.einsum("cq,cqsi,st,cqtj->cij", strain.volume, strain.nodal, law, strain.nodal)
    operator = assembly.build(mesh, 1.0, 1e6, 0.25, fixed=())
    reduced = operator._replace(shape_class=np.arange(len(few), dtype=np.uint32), stiffness=few)
    assert np.abs(stress(mesh, inside, assembly.sparse(reduced)) - EVEN).max() > 1e-3 * 2000.0


def without_middles(operator):
    """The same mesh of four-node tetrahedra: what is left when every middle stays half way between
    its corners."""
    weights = np.zeros((10, 4))
    weights[:4] = np.eye(4)
    weights[np.arange(4, 10)[:, None], tetrahedron.EDGES] = 0.5
    tie = np.kron(weights, np.eye(3))
    stiffness = np.zeros_like(operator.stiffness)
    stiffness[:, :12, :12] = tie.T @ operator.stiffness @ tie
    corners, share = (
        operator.cells[:, :4].ravel(),
        operator.node_mass[operator.shape_class].sum(axis=1) / 4.0,
    )
    mass = np.bincount(corners, np.repeat(share, 4), minlength=len(operator.mass))
    return operator._replace(stiffness=stiffness, mass=mass, free=operator.free & (mass > 0.0))


@pytest.mark.case("O6")
@pytest.mark.parametrize("divisions", [COARSE, (40, 1, 2)])
def test_cantilever_deflection(divisions):
    mesh = beam(divisions)
    operator = assembly.build(mesh, **ALUMINIUM, fixed=())
    exact = sum(elasticity.cantilever_deflection(FORCE, **BEAM, **ELASTIC))
    assert deflection(mesh, operator)[0] == pytest.approx(exact, rel=0.01)


@pytest.mark.case("O7")
@pytest.mark.parametrize("divisions", [COARSE, (40, 2, 2)])
def test_cantilever_frequencies(divisions):
    exact = elasticity.timoshenko_cantilever(2, **BEAM, **ALUMINIUM)
    assert bending_frequencies(assembly.build(beam(divisions), **ALUMINIUM), 2) == pytest.approx(
        exact, rel=0.01
    )


@pytest.mark.case("O7")
def test_four_node_tetrahedra_lock():
    """Control: without middles a mesh twice as fine is far too stiff, by 45 % in frequency."""
    exact = elasticity.timoshenko_cantilever(1, **BEAM, **ALUMINIUM)
    plain = without_middles(assembly.build(beam((40, 2, 2)), **ALUMINIUM))
    assert (bending_frequencies(plain, 1) > 1.2 * exact).all()


@pytest.mark.case("O8")
def test_free_beam_frequencies():
    exact = elasticity.timoshenko_free(2, **BEAM, **ALUMINIUM)
    rigid, flexible = free_frequencies(assembly.build(beam((30, 1, 1)), **ALUMINIUM, fixed=()))
    assert flexible[:2] == pytest.approx(exact, rel=0.01)
    assert rigid.max() < 1e-5 * flexible[0]


def bulged():
    """A drum-shaped block: the edges on its sides are curved, and its volume (m3)."""
    mesh = beam((6, 1, 1))
    return tets.bent(
        mesh,
        lambda x: np.column_stack(
            [x[:, 0], x[:, 1] * (1.0 + x[:, 0]), x[:, 2] * (1.0 + 0.5 * x[:, 0])]
        ),
    )


@pytest.mark.parametrize(
    "mesh", [pytest.param(beam(), id="straight"), pytest.param(bulged(), id="curved")]
)
def test_masses_are_positive_and_add_up(mesh):
    operator = assembly.build(mesh, **ALUMINIUM)
    volume = tetrahedron.kinematics(mesh.points[mesh.cells]).volume
    assert operator.node_mass.min() > 0.0
    assert operator.mass.sum() == pytest.approx(ALUMINIUM["density"] * volume.sum(), rel=1e-12)


def test_volume_of_curved_elements():
    """Sides drawn out as 1 + x and 1 + x/2: 0.03 x 0.04 x integral of (1 + x) (1 + x/2) over 0.6 m;
    edges follow the parabola that a product of two lines is, but for the terms across."""
    volume = tetrahedron.kinematics(bulged().points[bulged().cells]).volume.sum()
    assert volume == pytest.approx(0.03 * 0.04 * (0.6 + 0.75 * 0.36 + 0.5 * 0.216 / 3.0), rel=1e-3)


def test_straight_masses_are_those_of_the_scaled_diagonal():
    """1/36 of the element at each corner, 4/27 at each middle (Hinton, Rock, Zienkiewicz)."""
    shares = assembly.build(beam(), **ALUMINIUM).node_mass
    assert shares / shares.sum(axis=1, keepdims=True) == pytest.approx(
        np.tile([1 / 36] * 4 + [4 / 27] * 6, (len(shares), 1))
    )


def test_row_sums_would_make_every_step_unstable():
    """Control: masses by row sums are negative at corners, so M^-1 K has a negative eigenvalue,
    which grows without bound."""
    mesh = beam((2, 1, 1))
    operator = assembly.build(mesh, **ALUMINIUM, fixed=())
    share = np.array([-1 / 20] * 4 + [1 / 5] * 6)
    total = operator.node_mass[operator.shape_class].sum(axis=1)
    rows = np.bincount(
        mesh.cells.ravel(), np.outer(total, share).ravel(), minlength=len(mesh.points)
    )
    assert rows.min() < 0.0 and rows.sum() == pytest.approx(operator.mass.sum())
    stiffness = assembly.sparse(operator).toarray()
    for mass, grows in ((rows, True), (operator.mass, False)):
        squares = np.linalg.eigvals(stiffness / np.repeat(mass, 3)[:, None]).real
        assert (squares.min() < -1e-6 * squares.max()) == grows


@pytest.mark.case("O12")
@pytest.mark.parametrize(
    "mesh", [pytest.param(beam((3, 1, 1)), id="straight"), pytest.param(bulged(), id="curved")]
)
def test_rigid_motion_is_free_and_nothing_else(mesh):
    operator = assembly.build(mesh, **ALUMINIUM)
    eigenvalues = np.linalg.eigvalsh(operator.stiffness)
    assert (
        np.abs(eigenvalues[:, :6]).max() < 1e-12 * eigenvalues.max()
        and (eigenvalues[:, 6] > 1e-5 * eigenvalues[:, -1]).all()
    )
    rigid, force = (
        np.array([0.3, -0.2, 0.5]) + np.cross([0.7, -0.4, 0.2], mesh.points),
        np.empty_like(mesh.points),
    )
    internal_force(rigid, operator.cells, operator.shape_class, operator.stiffness, force)
    assert np.abs(force).max() < 1e-12 * np.abs(operator.stiffness).max()
    internal_force(
        np.ones_like(rigid), operator.cells, operator.shape_class, operator.stiffness, force
    )
    assert not force.any()


def test_kernel_agrees_with_the_assembled_matrix():
    operator = assembly.build(bulged(), **ALUMINIUM)
    displacement = np.random.default_rng(3).standard_normal((len(operator.mass), 3))
    force = np.empty_like(displacement)
    internal_force(displacement, operator.cells, operator.shape_class, operator.stiffness, force)
    expected = (assembly.sparse(operator) @ displacement.ravel()).reshape(-1, 3)
    assert np.abs(force - expected).max() < 1e-14 * 4.0 * np.abs(expected).max()


@pytest.mark.parametrize(
    "mesh", [pytest.param(beam((4, 1, 1)), id="straight"), pytest.param(bulged(), id="curved")]
)
def test_bounds_enclose_the_highest_frequency(mesh):
    operator = assembly.build(mesh, **ALUMINIUM)
    exact, bound = highest_mode(operator)[0], stable_step.operator_bound(operator)
    assert bound.ritz <= exact * (1.0 + 1e-12) and exact <= bound.upper <= exact * 1.002
    assert bound.upper <= stable_step.element_bound(operator)
