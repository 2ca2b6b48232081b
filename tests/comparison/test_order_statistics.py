"""Bounds from the order of draws: exact numbers of runs, and coverage."""

import numpy as np
import pytest
from scipy import stats

from tipoff.comparison.order_statistics import bounds, runs_needed


@pytest.mark.case("O49")
@pytest.mark.parametrize(
    "share, sides, runs", [(0.95, 1, 59), (0.95, 2, 93), (0.99, 1, 299), (0.9973, 1, 1109)]
)
def test_runs_needed(share, sides, runs):
    """Both sides of the threshold, from the law of the share that the extreme draws hold: beta(n,
    1) and beta(n - 1, 2)."""
    assert runs_needed(share, 0.95, sides) == runs
    assert (
        stats.beta(runs + 1 - sides, sides).sf(share)
        >= 0.95
        > stats.beta(runs - sides, sides).sf(share)
    )


def test_bounds_exist_from_the_needed_number_of_runs_on():
    """Two-sided bounds leave 2.5 % on each side, so the largest draw is an upper bound from 0.95^n
    <= 0.025 on: 72."""
    assert bounds(np.arange(71.0), 0.95)[1] is None
    assert bounds(np.arange(72.0), 0.95)[1] == 71.0
    assert bounds(np.arange(3.0), 0.05)[0] is None


@pytest.mark.parametrize("count", [1, 2, 71, 72, 500])
def test_bounds_are_those_of_the_test_of_a_quantile(count):
    values = np.random.default_rng(3).normal(size=count)
    for share in (0.0027, 0.05, 0.5, 0.95, 0.9973):
        expected = stats.quantile_test(values, p=share).confidence_interval(0.95)
        found = [np.nan if end is None else end for end in bounds(values, share)]
        np.testing.assert_array_equal(found, expected)


def test_bounds_have_their_coverage():
    random, held, tries = np.random.default_rng(2), 0, 1000
    for _ in range(tries):
        low, high = bounds(random.exponential(size=200), 0.9)
        held += low <= -np.log(0.1) <= high
    # Ranks are whole numbers, so the confidence is a little above the given one: at least 95 %,
    # less 3 standard errors of the count.
    assert held >= 950 - 3.0 * np.sqrt(tries * 0.95 * 0.05)
    assert held < tries
