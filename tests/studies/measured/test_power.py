"""What it is worth that all tests lie in the range: against enumeration, the figures of the paper's
setting, and brute force."""

from itertools import permutations

import numpy as np
import pytest

from tipoff.studies.measured import power


@pytest.mark.parametrize("cases, tests", [(2, 1), (3, 2), (4, 3), (5, 2)])
def test_closed_form_is_the_count_of_orders(cases, tests):
    """Every order of all draws is equally likely; those count that begin and end with a simulated
    case."""
    orders = list(permutations(range(cases + tests)))
    passing = sum(order[0] < cases and order[-1] < cases for order in orders)
    assert power.inside_range(cases, tests) == pytest.approx(passing / len(orders), rel=1e-14)


def test_three_tests_in_a_thousand_cases():
    """99.4 % for a right model, all but certain for one three times too wide, and most of the time
    for one half as wide."""
    assert power.inside_range(1000, 3) == pytest.approx(1000 * 999 / (1003 * 1002), rel=1e-15)
    assert round(100 * power.inside_range(1000, 3), 1) == 99.4
    assert 1.0 - power.inside_range_of(1000, 3, 3.0) < 1e-6
    assert 0.6 < power.inside_range_of(1000, 3, 0.5) < 0.8
    error = 3.3 * np.sqrt(0.006 * 0.994 / 200_000)
    assert power.inside_range_of(1000, 3, 1.0) == pytest.approx(
        power.inside_range(1000, 3), abs=error
    )


@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_monte_carlo_over_the_range_is_brute_force(factor):
    rng = np.random.default_rng(1)
    cases, tests = factor * rng.standard_normal((20_000, 30)), rng.standard_normal((20_000, 2))
    passing = (
        (tests.min(axis=1) >= cases.min(axis=1)) & (tests.max(axis=1) <= cases.max(axis=1))
    ).mean()
    assert power.inside_range_of(30, 2, factor) == pytest.approx(
        passing, abs=3.3 * np.sqrt(passing * (1 - passing) / 20_000)
    )


@pytest.mark.parametrize("factor", [1.0 / 3.0, 1.0, 3.0])
def test_power_of_the_spread_is_brute_force(factor):
    from scipy.stats import chi2

    sums = (np.random.default_rng(2).standard_normal((20_000, 9)) ** 2).sum(axis=1) / factor**2
    flagged = ((sums < chi2.ppf(0.025, 9)) | (sums > chi2.ppf(0.975, 9))).mean()
    assert power.flagged(3, factor) == pytest.approx(flagged, abs=3.3 * np.sqrt(0.25 / 20_000))
    assert power.flagged(3, 1.0) == pytest.approx(0.05, rel=1e-12)


def test_table_has_a_row_for_every_factor():
    rows = power.table(np.random.default_rng(3).standard_normal((1000, 3)), 3)
    assert [row.factor for row in rows] == list(power.FACTORS)
    assert rows[2].passes_in_cloud is None
    assert rows[2].passes_one_axis == power.inside_range(1000, 3)
    assert all(row.passes_three_axes == row.passes_one_axis**3 for row in rows)


def test_in_a_normal_cloud_both_are_those_of_a_normal_distribution():
    """And in a cloud of two thin rings they are not: the formulas are no more than an
    orientation."""
    rng = np.random.default_rng(4)
    normal = rng.standard_normal((4000, 3))
    for factor in (0.5, 1.0, 2.0):
        held, seen = power.in_cloud(normal, 3, factor)
        assert seen == pytest.approx(power.flagged(3, factor), abs=0.03)
        assert held == pytest.approx(
            1.0 if factor == 1.0 else power.inside_range_of(4000, 3, factor) ** 3, abs=0.05
        )
    ring = (
        normal / np.linalg.norm(normal, axis=1, keepdims=True) * rng.choice([1.0, 1.1], (4000, 1))
    )
    assert power.in_cloud(ring, 3, 2.0)[1] == 1.0 > power.flagged(3, 2.0) + 0.1
