"""Observed order and grid convergence index, against a published check and series that are known
exactly."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tipoff.studies.convergence import extrapolation

# Pressure recovery of a supersonic inlet on three grids, coarsest first: NASA Glenn, NPARC Alliance
# CFD verification tutorial, "Examining spatial (grid) convergence".
SIZES, RECOVERY = (4.0, 2.0, 1.0), (0.96178, 0.96854, 0.97050)


def test_published_check():
    order = extrapolation.observed_order(SIZES, RECOVERY)
    assert order == pytest.approx(1.786170, abs=5e-7)
    assert 100.0 * extrapolation.grid_convergence_index(SIZES, RECOVERY, order) == pytest.approx(
        0.103083, abs=5e-7
    )
    assert extrapolation.extrapolated(SIZES, RECOVERY, order) == pytest.approx(0.97130, abs=5e-6)
    found = extrapolation.estimate(SIZES, RECOVERY)
    assert (found.order, found.method) == (order, "GCI")
    assert found.gci_percent == pytest.approx(0.103083, abs=5e-7)
    assert found.uncertainty == pytest.approx(0.00103083 * 0.97050, rel=1e-5)


@given(
    limit=st.floats(-5.0, 5.0),
    slope=st.sampled_from([-3.0, -0.2, 0.2, 3.0]),
    order=st.floats(0.6, 3.0),
    coarser=st.floats(1.3, 4.0),
    finer=st.floats(1.3, 4.0),
)
def test_manufactured_series_gives_back_its_order_and_its_limit(
    limit, slope, order, coarser, finer
):
    """f_0 + a h^p on grids whose two ratios differ."""
    sizes = (coarser * finer, finer, 1.0)
    values = [limit + slope * size**order for size in sizes]
    assert extrapolation.observed_order(sizes, values) == pytest.approx(order, abs=1e-7)
    assert extrapolation.extrapolated(sizes, values, order) == pytest.approx(limit, abs=1e-9)


@given(limit=st.floats(0.5, 5.0), slope=st.floats(0.01, 3.0), ratio=st.floats(1.3, 4.0))
def test_second_order_series_is_bounded_by_five_quarters_of_its_error(limit, slope, ratio):
    sizes = (ratio**2, ratio, 1.0)
    values = [limit + slope * size**2 for size in sizes]
    found = extrapolation.estimate(sizes, values)
    assert found.order == pytest.approx(2.0, abs=1e-8)
    assert found.uncertainty == pytest.approx(1.25 * slope, rel=1e-6)
    assert found.gci_percent == pytest.approx(125.0 * slope / values[2], rel=1e-6)


@pytest.mark.parametrize(
    "values, order, uncertainty, words",
    [
        ((1.0, 3.0, 2.0), None, 3.0, "not monotone: three times half the range"),
        ((1.0, 2.0, 2.0), None, 1.5, "not monotone: three times half the range"),
        ((0.0, 1.0, 5.0), -2.0, 7.5, "order below 0.5: three times half the range"),
        ((0.0, 1.0, 2.0), 0.0, 3.0, "order below 0.5: three times half the range"),
        ((0.0, 8.0, 9.0), 3.0, 1.25 / 3.0, "GCI, order limited to 2"),
        ((7.0, 7.0, 7.0), None, 0.0, "no change at all"),
        ((None, 3.0, 2.0), None, None, "a run did not settle"),
    ],
)
def test_values_that_show_no_order_say_so(values, order, uncertainty, words):
    found = extrapolation.estimate(SIZES, values)
    assert (found.uncertainty, found.method) == (pytest.approx(uncertainty), words)
    assert found.order == (None if order is None else pytest.approx(order, abs=1e-9))


def test_only_the_three_finest_grids_count():
    assert extrapolation.estimate((8.0, *SIZES), (0.0, *RECOVERY)) == extrapolation.estimate(
        SIZES, RECOVERY
    )


def test_value_of_zero_has_an_uncertainty_but_no_percentage():
    found = extrapolation.estimate(SIZES, (16.0, 4.0, 0.0))
    assert found.gci_percent is None and found.uncertainty > 0.0
    assert math.isfinite(found.uncertainty)


@pytest.mark.parametrize("sizes", [(1.0, 2.0, 4.0), (4.0, 4.0, 2.0), (4.0, 2.0), (4.0, 2.0, 0.0)])
def test_grids_must_be_three_and_get_finer(sizes):
    with pytest.raises(ValueError, match="three falling sizes"):
        extrapolation.observed_order(sizes, RECOVERY)
