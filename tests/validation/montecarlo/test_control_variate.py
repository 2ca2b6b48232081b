"""Mean and standard deviation corrected by a control variate, on populations with known answers."""

import math

import numpy as np
import pytest
from scipy import stats

from tests.validation.montecarlo.synthetic_pairs import Exponential, Normal, covered, repetitions
from validation.montecarlo import allocation, control_variate
from validation.montecarlo.allocation import Allocation
from validation.montecarlo.control_variate import Pairs

REPETITIONS = 400
# 2.6 standard deviations of a share of 400 about 95 %
NOMINAL = (0.92, 0.98)


def test_a_surrogate_that_is_off_by_scale_and_bias_is_corrected_to_the_bit_of_rounding():
    """y = 3 - 2 x: mean and standard deviation are those of 3 - 2 x over all cases, with the
    uncertainty of these cases alone."""
    population = np.random.default_rng(1).gamma(2.0, size=500)
    pairs = Pairs(3.0 - 2.0 * population[:20], population[:20], population)
    found = control_variate.mean(pairs)
    assert found.value == pytest.approx(3.0 - 2.0 * population.mean(), rel=1e-12)
    half = stats.t.ppf(0.975, 18) * 2.0 * population.std() / math.sqrt(500)
    assert found.high - found.value == pytest.approx(half, rel=1e-9)
    spread = control_variate.standard_deviation(pairs)
    assert spread.value == pytest.approx(2.0 * population.std(ddof=1), rel=1e-12)
    assert spread.low < spread.value < spread.high < spread.plain_high
    # of ln s, by the delta method
    error = math.sqrt((stats.kurtosis(population, fisher=False) - 1.0) / (4.0 * 500))
    half = stats.t.ppf(0.975, 18) * error
    assert math.log(spread.high / spread.value) == pytest.approx(half, rel=2.0 / 500)
    assert math.log(spread.value / spread.low) == pytest.approx(half, rel=2.0 / 500)


def test_a_surrogate_that_explains_nothing_leaves_the_mean_of_the_reference():
    """A constant control has no correlation. The interval is Student's, with one degree less."""
    random = np.random.default_rng(2)
    values = random.normal(size=30)
    found = control_variate.mean(Pairs(values, np.ones(30), np.ones(900)))
    assert found.value == pytest.approx(values.mean(), abs=1e-15)
    half = stats.t.ppf(0.975, 28) * stats.sem(values)
    assert found.high - found.value == pytest.approx(half, rel=1e-9)
    assert (found.low, found.high) == (found.plain_low, found.plain_high)
    assert control_variate.equivalent_runs(found, 30) == pytest.approx(30.0)
    assert control_variate.correlation(values, np.ones(30)) is None


def test_a_quantity_that_does_not_vary_has_no_interval():
    found = control_variate.standard_deviation(Pairs(np.zeros(9), np.arange(9.0), np.arange(99.0)))
    assert found.value == 0.0 and found.low is found.plain_high is None
    assert control_variate.equivalent_runs(found, 9) is None


def test_one_draw_that_differs_gives_no_interval_and_no_number_that_is_none():
    """Without that draw nothing varies. Control: two such draws."""
    population = np.random.default_rng(3).normal(size=200)
    for different, has_bounds in ((1, False), (2, True)):
        values = np.where(np.arange(20) < different, 1.0 + np.arange(20.0), 0.0)
        for reference, surrogate in ((values, population[:20]), (population[:20], values)):
            found = control_variate.standard_deviation(Pairs(reference, surrogate, population))
            assert (found.high is not None) == has_bounds
            assert np.isfinite([each for each in vars(found).values() if each is not None]).all()


@pytest.mark.parametrize("law", [Normal, Exponential])
def test_intervals_of_the_mean_hold_the_truth_as_often_as_they_say(law):
    """Controls: the interval of the surrogate's own mean, whose bias it does not see, and the
    narrow interval about the mean of the reference that is not corrected."""
    pairs = list(repetitions(law, 0.95, 60, 3000, REPETITIONS))
    found = [control_variate.mean(each) for each in pairs]
    assert NOMINAL[0] < covered([(each.low, each.high) for each in found], law.mean) < NOMINAL[1]
    own = [
        each.surrogate + np.array([-2.0, 2.0]) * stats.sem(pair.population)
        for each, pair in zip(found, pairs)
    ]
    assert covered(own, law.mean) < 0.05
    moved = [
        (each.low + each.plain - each.value, each.high + each.plain - each.value) for each in found
    ]
    assert covered(moved, law.mean) < 0.7


def test_intervals_of_the_standard_deviation_hold_the_truth_as_often_as_they_say():
    """The control is the standard deviation of the surrogate, three quarters of the true one."""
    pairs = list(repetitions(Normal, 0.95, 100, 3000, REPETITIONS))
    found = [control_variate.standard_deviation(each) for each in pairs]
    assert NOMINAL[0] < covered([(each.low, each.high) for each in found], Normal.sd) < NOMINAL[1]
    error = 1.0 / math.sqrt(2.0 * 3000)  # relative, of a normal population
    own = [(each.surrogate * (1.0 - 2.0 * error), each.surrogate * 1.02) for each in found]
    assert covered(own, Normal.sd) < 0.05


def test_the_variance_is_that_of_theory():
    """[1 - (1 - n/N) r^2] var(y) / n; a coefficient from 60 draws adds 1/58. Control: var(y) / n."""
    found = [
        control_variate.mean(each) for each in repetitions(Normal, 0.9, 60, 600, 4 * REPETITIONS)
    ]
    theory = (1.0 - 0.9 * 0.81) * 4.0 / 60
    # the standard deviation of a variance of 1,600 values is 3.5 %
    assert np.var([each.value for each in found]) == pytest.approx(theory, rel=0.12)
    assert np.var([each.plain for each in found]) == pytest.approx(4.0 / 60, rel=0.12)
    runs = np.median([control_variate.equivalent_runs(each, 60) for each in found])
    assert runs == pytest.approx(60.0 * (4.0 / 60) / theory, rel=0.15)


@pytest.mark.parametrize(("correlation", "ratio"), [(0.9, 30.0), (0.999, 1e4), (0.5, 1e5)])
def test_no_other_allocation_has_a_smaller_variance_at_the_same_cost(correlation, ratio):
    """Cost n (w + N/n) of the surrogate, variance [1 - (1 - n/N) r^2] / n: the smallest product over
    a grid, against that of the reference alone, w."""
    cases = np.geomspace(1.0, 1e7, 200_001)
    product = (1.0 - (1.0 - 1.0 / cases) * correlation**2) * (ratio + cases) / ratio
    found = allocation.optimal(correlation, ratio)
    assert found.variance_ratio == pytest.approx(product.min(), rel=1e-8)
    assert found.cases_per_run == pytest.approx(cases[product.argmin()], rel=1e-3)


def test_a_surrogate_that_saves_nothing_is_not_run():
    assert allocation.optimal(0.3, 2.0) == allocation.optimal(0.0, 1e6) == Allocation(1.0, 1.0)
    assert allocation.optimal(1.0, 100.0) == Allocation(None, pytest.approx(0.01))
