"""A rail that nothing holds: six rigid motions, momenta in the explicit loop, static loads balanced
by acceleration."""

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import ALUMINIUM, block, free_stiffness, modes, static
from tests.highfi.leapfrog import driven
from tipoff.highfi.mesh.rail_mesh import RailMesh, read
from tipoff.highfi.statics import assembly, stable_step
from tipoff.meshes import l_rail


@pytest.fixture(scope="module")
def rail():
    """One of the four L rails."""
    four = read(l_rail.build(l_rail.LRailGeometry(), 0.008))
    count = len(four.points) // 4
    return RailMesh(four.points[:count], four.cells[(four.cells < count).all(axis=1)], {})


@pytest.mark.case("X16")
def test_free_rail_has_six_rigid_motions(rail):
    operator = assembly.build(rail, **ALUMINIUM, fixed=())
    frequencies = np.sort(modes(operator, 8, shift=-1e6)[0])
    assert frequencies[5] < 1e-5 * frequencies[6]
    # No zero frequency is divided by where the step is chosen.
    exact = 2.0 / stable_step.operator_bound(operator).upper
    assert stable_step.critical_step(stable_step.element_bound(operator)) <= exact < 1e-6


@pytest.mark.case("X16")
@pytest.mark.parametrize("fraction", [0.9, 0.45])
def test_loaded_free_rail_keeps_its_momenta(rail, fraction):
    """Under constant forces p = F t and, about the undeformed places, L = M t, but for rounding:
    each product of a stiffness and a displacement is wrong by an ulp at most, in no common
    direction, and the displacement is largest at the end."""
    operator = assembly.build(rail, **ALUMINIUM, fixed=())
    load = np.random.default_rng(7).standard_normal(rail.points.shape)
    force, moment = load.sum(axis=0), np.cross(rail.points, load).sum(axis=0)
    step = fraction * stable_step.critical_step(stable_step.element_bound(operator))
    displacement, velocity = np.zeros(rail.points.shape), np.zeros(rail.points.shape)
    times = driven(operator, step, lambda *_: load, displacement, velocity)
    for _ in range(5000):
        time = next(times) - 0.5 * step
    momentum = operator.mass[:, None] * velocity
    products = operator.stiffness[operator.shape_class] * displacement[operator.cells].reshape(
        -1, 1, 24
    )
    rounding = np.finfo(float).eps * np.linalg.norm(products)
    assert rounding < 1e-11 * np.abs(load).sum()  # so that a force out of nothing would show
    assert np.abs(momentum.sum(axis=0) / time - force).max() < rounding
    turning = np.cross(rail.points, momentum).sum(axis=0)
    assert (
        np.abs(turning / time - moment).max() < rounding * np.linalg.norm(rail.points, axis=1).max()
    )


@pytest.mark.case("X16")
@pytest.mark.parametrize("elements", [10, 20])
def test_static_load_balanced_by_acceleration(elements):
    """A free bar pushed at one end with 1000 N shortens by F L / 2 E A = 8.6806 um: by the sum over
    its flexible modes alone, and by the static answer to the force less mass times acceleration, in
    which six held freedoms take no reaction."""
    length, width, modulus, density, force = 0.5, 0.02, 72e9, 2810.0, 1000.0
    mesh = block((elements, 1, 1), (length, width, width))
    operator = assembly.build(mesh, density, modulus, 0.0, fixed=())
    near, far = mesh.points[:, 0] == 0.0, mesh.points[:, 0] == length
    load = np.zeros(mesh.points.shape)
    load[near, 0] = force / near.sum()
    stiffness, mass, _ = free_stiffness(operator)
    squares, vectors = np.linalg.eigh(stiffness.toarray() / np.sqrt(np.outer(mass, mass)))
    flexible = squares > 1e-9 * squares[-1]
    assert (~flexible).sum() == 6
    shapes = vectors[:, flexible] / np.sqrt(mass)[:, None]
    modal = (shapes @ (shapes.T @ load.ravel() / squares[flexible])).reshape(-1, 3)
    balanced = load - operator.mass[:, None] * load.sum(axis=0) / operator.mass.sum()
    held = np.zeros(mesh.points.shape, dtype=bool)
    held[0], held[1, :2], held[2, 0] = True, True, True
    answer = static(operator, balanced, held)
    reaction = (assembly.sparse(operator) @ answer.ravel()).reshape(-1, 3) - balanced
    assert np.abs(reaction).max() < 1e-9 * force
    exact = 0.5 * elasticity.largest_shortening(force, length, width**2, modulus)
    assert exact == pytest.approx(8.6806e-6, abs=5e-11)
    for found in (modal, answer):
        assert found[near, 0].mean() - found[far, 0].mean() == pytest.approx(exact, rel=1e-6)
