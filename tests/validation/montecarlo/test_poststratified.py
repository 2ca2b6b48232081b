"""Probabilities and quantiles corrected by strata of the surrogate's answer, on populations with
known answers."""

import numpy as np
import pytest
from scipy.stats import beta, binomtest

from tests.validation.montecarlo.synthetic_pairs import Exponential, Normal, covered, repetitions
from validation.montecarlo import poststratified
from validation.montecarlo.control_variate import Pairs

REPETITIONS = 400
NOMINAL = (0.92, 0.98)


def test_it_is_the_control_variate_with_the_optimal_coefficient():
    random = np.random.default_rng(1)
    both = random.random(50) < 0.4
    surrogate = np.where(random.random(50) < 0.8, both, ~both)
    found = poststratified.probability(both, surrogate, 0.31, 10**6)
    slope = np.cov(both, surrogate)[0, 1] / surrogate.var(ddof=1)
    assert found.value == pytest.approx(both.mean() + slope * (0.31 - surrogate.mean()), rel=1e-12)
    assert found.plain == both.mean() and found.surrogate == 0.31


@pytest.mark.parametrize("count", [0, 1, 7, 40])
def test_the_interval_is_that_of_wilson_where_the_surrogate_explains_nothing(count):
    """A surrogate that never says yes has one stratum."""
    event = np.arange(40) < count
    found = poststratified.probability(event, np.zeros(40, bool), 0.0, 10**6)
    expected = binomtest(count, 40).proportion_ci(0.95, method="wilson")
    for low, high in ((found.low, found.high), (found.plain_low, found.plain_high)):
        assert (low, high) == pytest.approx(tuple(expected), abs=1e-12)
    assert found.value == count / 40


def test_draws_that_agree_are_no_proof():
    """Sixty draws without an event in either model: the upper bound is near that of sixty draws
    without an event, and not the surrogate's own answer."""
    never = np.zeros(60, bool)
    found = poststratified.probability(never, never, 1e-4, 10**6)
    assert found.value == pytest.approx(1e-4)
    assert found.high == pytest.approx(
        binomtest(0, 60).proportion_ci(method="wilson").high, rel=0.01
    )


@pytest.mark.parametrize("law", [Normal, Exponential])
@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_intervals_of_a_probability_hold_the_truth_as_often_as_they_say(law, correlation):
    """One in ten. Control: the interval of the surrogate's own share of the same event."""
    threshold, bounds, own = law.quantile(0.9), [], []
    for pair in repetitions(law, correlation, 150, 3000, REPETITIONS, 4):
        share = float((pair.population > threshold).mean())
        found = poststratified.probability(
            pair.reference > threshold, pair.surrogate > threshold, share, 3000
        )
        bounds.append((found.low, found.high))
        above = round(3000 * share)
        own.append(beta.ppf([0.025, 0.975], [above, above + 1], [3001 - above, 3000 - above]))
    assert NOMINAL[0] < covered(bounds, 0.1) < NOMINAL[1]
    assert covered(own, 0.1) < 0.05


@pytest.mark.parametrize("cases", [1000, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("law", "share"), [(Normal, 0.5), (Exponential, 0.9)])
def test_intervals_of_a_quantile_hold_the_truth_as_often_as_they_say(law, share, cases):
    require_coverage(law, share, cases)


@pytest.mark.slow
@pytest.mark.parametrize(("law", "share"), [(Normal, 0.9), (Exponential, 0.5)])
def test_so_do_those_of_other_quantiles(law, share):
    require_coverage(law, share, 3000)


def require_coverage(law, share, cases):
    """Control: the interval without its lower half."""
    pairs = list(repetitions(law, 0.9, 150, cases, REPETITIONS, 3))
    found = [poststratified.quantile(each, share) for each in pairs]
    truth = law.quantile(share)
    assert NOMINAL[0] < covered([(each.low, each.high) for each in found], truth) < NOMINAL[1]
    assert covered([(each.value, each.high) for each in found], truth) < 0.7
    # nearer to the truth than the reference alone, and than the surrogate with its bias
    errors = {
        name: np.sqrt(np.mean([(getattr(each, name) - truth) ** 2 for each in found]))
        for name in ("value", "plain", "surrogate")
    }
    assert errors["value"] < 0.85 * errors["plain"] < errors["surrogate"]


def test_a_quantile_beyond_all_draws_has_no_bound():
    """Thirty draws cannot bound what one in a thousand exceeds. Control: the median."""
    population = np.random.default_rng(5).normal(size=5000)
    pairs = Pairs(population[:30] + 0.1, population[:30], population)
    assert poststratified.quantile(pairs, 0.999).high is None
    median = poststratified.quantile(pairs, 0.5)
    assert median.low < 0.1 < median.high
