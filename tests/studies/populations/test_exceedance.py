"""Limits of rates from texts; the bounds of a probability against closed forms, and their
coverage."""

import numpy as np
import pytest
from scipy import stats

from tipoff.comparison import order_statistics
from tipoff.faults import SceneError
from tipoff.studies.populations import exceedance
from tipoff.studies.populations.exceedance import Limit


def test_limits_are_read_with_their_axis():
    assert exceedance.limits(["x=2 deg/s", " z = 0.1 rad/s", "5 deg/s", "total=6 deg/s"]) == [
        Limit("x", pytest.approx(2.0)),
        Limit("z", pytest.approx(np.degrees(0.1))),
        Limit("total", pytest.approx(5.0)),
        Limit("total", pytest.approx(6.0)),
    ]


def test_every_fault_of_every_limit_is_listed():
    with pytest.raises(SceneError) as refused:
        exceedance.limits(
            ["roll=2 deg/s", "x=2 mm", "y=-1 deg/s", "5", "z=nan deg/s", "w=0 deg/s", "x=1 deg/s"]
        )
    text = str(refused.value)
    assert "7 faults" in text and all(
        words in text for words in ("roll", "2 mm", "more than zero", "nan", "given 5")
    )


def test_above_counts_magnitudes_and_cases_that_did_not_settle():
    rates = np.array(
        [[-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], [np.nan] * 3, [1.5, 1.5, 1.5], [2.0, 0.0, 0.0]]
    )
    assert exceedance.above(rates, Limit("x", 2.0)).tolist() == [True, False, True, False, False]
    assert exceedance.above(rates, Limit("total", 2.0)).tolist() == [True, False, True, True, False]
    assert exceedance.any_above(rates, [Limit("x", 2.0), Limit("y", 1.0)]).tolist() == [
        True,
        False,
        True,
        True,
        False,
    ]


def test_bounds_with_none_and_all_above_have_closed_forms():
    """None of n: at most 1 - a^(1/n); the two-sided bound leaves half of a on each side."""
    assert exceedance.at_most(0, 100, 0.95) == pytest.approx(1.0 - 0.05**0.01, rel=1e-9)
    assert exceedance.bounds(0, 100, 0.95) == pytest.approx((0.0, 1.0 - 0.025**0.01), rel=1e-9)
    assert exceedance.bounds(100, 100, 0.95) == pytest.approx((0.025**0.01, 1.0), rel=1e-9)
    assert exceedance.bounds(7, 50, 0.9) == pytest.approx(
        (stats.beta(7, 44).ppf(0.05), stats.beta(8, 43).ppf(0.95)), rel=1e-6
    )


@pytest.mark.parametrize("count, cases", [(1, 20), (7, 50), (3, 10_000), (990, 1000)])
def test_bounds_leave_the_tails_of_the_binomial_distribution(count, cases):
    """At the upper bound, ``count`` or fewer have the probability that the confidence leaves; at the
    lower bound, ``count`` or more."""
    low, high = exceedance.bounds(count, cases, 0.95)
    assert low < count / cases < high
    assert stats.binom.sf(count - 1, cases, low) == pytest.approx(0.025, rel=1e-9)
    assert stats.binom.cdf(count, cases, high) == pytest.approx(0.025, rel=1e-9)


@pytest.mark.case("O49")
@pytest.mark.parametrize("probability", [0.95, 0.99, 0.9973])
def test_the_first_allowed_number_of_cases_is_that_of_order_statistics(probability):
    """One run fewer than needed allows no count; with enough runs the count is the largest within
    the bound."""
    needed = order_statistics.runs_needed(probability)
    assert (
        exceedance.allowed(needed - 1, probability, 0.95) is None
        and exceedance.allowed(needed, probability, 0.95) == 0
    )
    for cases in (needed, 2 * needed, 10 * needed):
        count = exceedance.allowed(cases, probability, 0.95)
        assert (
            exceedance.at_most(count, cases, 0.95)
            <= 1.0 - probability
            < exceedance.at_most(count + 1, cases, 0.95)
        )


def test_bounds_have_their_coverage():
    counts, truth = np.random.default_rng(4).binomial(300, 0.03, 1000), 0.03
    held = np.mean([exceedance.at_most(int(count), 300, 0.95) >= truth for count in counts])
    # Exact bounds are on the safe side: at least 95 %, less 3 standard errors of the share.
    assert 0.95 - 3.0 * np.sqrt(0.05 * 0.95 / 1000) <= held < 1.0
