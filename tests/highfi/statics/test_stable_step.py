"""The stable step: its bounds, the steps a run may choose, and a loop that ignores them."""

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import ALUMINIUM, block, highest_mode
from tests.highfi.leapfrog import integrate
from tipoff.highfi.statics import assembly, stable_step

OVERSTEPS = (1.001, 1.01, 2.0)


@pytest.fixture(scope="module")
def operator():
    return assembly.build(block((4, 2, 2), (0.020, 0.008, 0.008)), **ALUMINIUM)


@pytest.fixture(scope="module")
def highest(operator):
    return highest_mode(operator)


def random_state(operator, scale=1e-6):
    displacement = scale * np.random.default_rng(4).standard_normal((operator.mass.size, 3))
    displacement[~operator.free] = 0.0
    return displacement, np.zeros_like(displacement)


@pytest.mark.case("O14")
@pytest.mark.parametrize("ratio", [0.9, 0.45])
@pytest.mark.parametrize("steps", [200_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
def test_invariant_of_the_scheme_does_not_drift(operator, highest, ratio, steps):
    displacement, velocity = random_state(operator)
    step = ratio * stable_step.critical_step(highest[0])
    _, invariant = integrate(operator, displacement, velocity, step, steps)
    assert np.abs(invariant / invariant[0] - 1.0).max() < 1e-12


@pytest.mark.case("O14")
def test_growth_above_the_critical_step(operator, highest):
    frequency, shape = highest
    assert elasticity.leapfrog_growth(1.01) == pytest.approx(1.326584, abs=1e-6)
    displacement, velocity = shape.copy(), np.zeros_like(shape)
    node, component = np.unravel_index(np.argmax(np.abs(shape)), shape.shape)
    trace, _ = integrate(
        operator,
        displacement,
        velocity,
        1.01 * stable_step.critical_step(frequency),
        60,
        (node, component),
    )
    assert -trace[-1] / trace[-2] == pytest.approx(elasticity.leapfrog_growth(1.01), abs=1e-6)


@pytest.mark.case("X13")
@pytest.mark.parametrize("ratio", OVERSTEPS)
def test_step_above_the_limit_is_refused_with_both_numbers(ratio):
    limit = 4e-7
    with pytest.raises(stable_step.StepError) as refusal:
        stable_step.choose_step(limit, 0.9, 1e-4, requested=ratio * limit)
    assert f"{ratio * limit:.6g} s" in str(refusal.value) and f"{limit:.6g} s" in str(refusal.value)


@pytest.mark.case("X13")
@pytest.mark.parametrize("ratio", OVERSTEPS)
def test_loop_without_the_check_diverges(operator, highest, ratio):
    """Control: a run with one of the refused steps diverges, and one with the step just below the
    limit does not."""
    largest = {}
    for factor in (ratio, 0.999):
        displacement, velocity = random_state(operator)
        integrate(
            operator, displacement, velocity, factor * stable_step.critical_step(highest[0]), 200
        )
        largest[factor] = np.abs(displacement).max()
    assert largest[0.999] < 1e-3
    assert largest[ratio] > 1.0


def test_chosen_step_divides_the_sample_interval():
    for limit in (1.7e-7, 3.3e-7, 9.99e-5, 1.0):
        step = stable_step.choose_step(limit, 0.9, 1e-4)
        count = 1e-4 / step
        assert step <= 0.9 * limit and count == pytest.approx(round(count), rel=1e-12)
        assert round(count) == 1 or 1e-4 / (round(count) - 1) > 0.9 * limit
    assert stable_step.choose_step(4e-7, 0.9, 1e-4, requested=4e-7) == 4e-7
    with pytest.raises(stable_step.StepError, match="does not divide"):
        stable_step.choose_step(4e-7, 0.9, 1e-4, requested=3e-7)


@pytest.mark.case("O15")
def test_damping_shortens_the_stable_step():
    frequency = 2.0 * np.pi * 30e3
    assert stable_step.critical_step(frequency) == pytest.approx(10.6103e-6, abs=1e-10)
    assert stable_step.critical_step(frequency, 0.05) == pytest.approx(10.0931e-6, abs=1e-10)


@pytest.mark.parametrize("springs", [0.0, 3e9])
def test_bounds_enclose_the_highest_frequency(operator, springs):
    added = np.zeros((operator.mass.size, 3))
    added[-1] = springs
    scale = np.repeat(np.where(operator.free, operator.mass**-0.5, 0.0), 3)
    matrix = assembly.sparse(operator).toarray() + np.diag(added.ravel())
    exact = np.sqrt(np.linalg.eigvalsh(matrix * scale[:, None] * scale)[-1])
    bound = stable_step.operator_bound(operator, added)
    assert bound.ritz <= exact * (1.0 + 1e-12) and exact <= bound.upper <= exact * 1.002
    if not springs:
        assert bound.upper < stable_step.element_bound(operator)


@pytest.mark.case("X14")
def test_step_of_a_sliver_follows_from_its_edge():
    """A 5 um layer brings the step down to its thickness over the pressure wave speed, 0.811 ns."""
    stations = [0.0, 0.005, 0.005005, 0.010005]
    sliver = assembly.build(block((3, 1, 1), (0.010, 0.005, 0.005), stations), **ALUMINIUM)
    crossing = 5e-6 / elasticity.confined_speed(
        ALUMINIUM["youngs_modulus"], ALUMINIUM["poisson_ratio"], ALUMINIUM["density"]
    )
    assert crossing == pytest.approx(0.811e-9, rel=1e-3)
    assert stable_step.critical_step(stable_step.element_bound(sliver)) == pytest.approx(
        crossing, rel=1e-3
    )


@pytest.mark.case("X15")
def test_nearly_incompressible_step_stays_below_the_wave_crossing():
    cube = assembly.build(block((1, 1, 1), (0.005, 0.005, 0.005)), 2810.0, 72e9, 0.4999)
    crossing = 0.005 / elasticity.confined_speed(72e9, 0.4999, 2810.0)
    assert crossing == pytest.approx(24.19e-9, rel=1e-3)
    assert 0.5 * crossing < stable_step.critical_step(stable_step.element_bound(cube)) <= crossing
