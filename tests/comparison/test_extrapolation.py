"""Observed order and grid convergence index, against a published check and series that are known
exactly."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tipoff.comparison import extrapolation

# Pressure recovery of a supersonic inlet on three grids, coarsest first: NASA Glenn, NPARC Alliance
# CFD verification tutorial, "Examining spatial (grid) convergence".
SIZES, RECOVERY = (4.0, 2.0, 1.0), (0.96178, 0.96854, 0.97050)


@pytest.mark.case("O72")
def test_published_check():
    order = extrapolation.observed_order(SIZES, RECOVERY)
    assert order == pytest.approx(1.786170, abs=5e-7)
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
def test_manufactured_series_gives_back_its_order(limit, slope, order, coarser, finer):
    """f_0 + a h^p on grids whose two ratios differ."""
    sizes = (coarser * finer, finer, 1.0)
    values = [limit + slope * size**order for size in sizes]
    assert extrapolation.observed_order(sizes, values) == pytest.approx(order, abs=1e-7)


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
        ((1.0, 3.0, 2.0), None, 3.0, "alternating: first order, factor 3"),
        ((1.0, 3.0, 0.5), None, 7.5, extrapolation.NOT_CONVERGED),
        ((1.0, 2.0, 2.0), None, 0.75, "last change almost zero: first order, factor 3"),
        ((1.0, 0.0, -1e-30), None, 0.75, "last change almost zero: first order, factor 3"),
        ((1.0, 0.0, 1e-30), None, 0.75, "alternating: first order, factor 3"),
        ((0.0, 1.0, 5.0), -2.0, 15.0, extrapolation.NOT_CONVERGED),
        ((0.0, 1.0, 2.0), 0.0, 6.0, extrapolation.NOT_CONVERGED),
        ((0.0, 8.0, 9.0), 3.0, 2.0, "GCI, order limited to 2, factor 3"),
        (
            (0.0, 5.0, 9.0),
            math.log2(1.25),
            12.0 / (math.sqrt(2.0) - 1.0),
            "GCI, order limited to 0.5, factor 3",
        ),
        ((7.0, 7.0, 7.0), None, 0.0, "no change at all"),
        ((None, 3.0, 2.0), None, None, "a run did not settle"),
        ((3.0, 2.0), None, 3.0, "two values: first order, factor 3"),
        ((2.0, 2.0), None, 0.0, "no change at all"),
        ((2.0,), None, None, "one grid: not known"),
    ],
)
def test_values_that_show_no_order_say_so(values, order, uncertainty, words):
    found = extrapolation.estimate(SIZES[-len(values) :], values)
    assert (found.uncertainty, found.method) == (pytest.approx(uncertainty), words)
    assert found.order == (None if order is None else pytest.approx(order, abs=1e-9))


@pytest.mark.case("O72")
@given(
    limit=st.floats(0.5, 5.0),
    slope=st.sampled_from([-0.3, 0.3]),
    order=st.floats(0.51, 2.0),
    ratio=st.floats(1.5, 3.0),
)
def test_the_error_lies_within_the_estimate_and_beyond_the_last_change(limit, slope, order, ratio):
    """Series of known order and limit: the estimate is 1.25 times the error at every order between
    a half and two. Control: the last change, taken as the uncertainty, misses the error where the
    order is low and the ratio small."""
    sizes = (ratio**2, ratio, 1.0)
    values = [limit + slope * size**order for size in sizes]
    error, change = abs(slope), abs(values[1] - values[2])
    assert extrapolation.estimate(sizes, values).uncertainty == pytest.approx(
        1.25 * error, rel=1e-5
    )
    assert (change < error) == (ratio**order < 2.0) or ratio**order == pytest.approx(2.0)


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0])
def test_two_grids_bound_the_error_of_any_order_from_the_first(order):
    """Control: of order 0.3 they do not, which is why a third grid is run."""
    values = [1.0 + 0.1 * size**order for size in (2.0, 1.0)]
    assert extrapolation.estimate((2.0, 1.0), values).uncertainty >= 0.1
    shallow = [1.0 + 0.1 * size**0.3 for size in (2.0, 1.0)]
    assert extrapolation.estimate((2.0, 1.0), shallow).uncertainty < 0.1


@given(st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3, unique=True))
def test_an_oscillating_series_is_never_called_converged_by_its_last_change(values):
    """Changes that do not fall say so, and their bound is above the last change."""
    found = extrapolation.estimate(SIZES, values)
    first, last = abs(values[0] - values[1]), abs(values[1] - values[2])
    assert (found.method == extrapolation.NOT_CONVERGED) == (last >= first)
    if last >= first:
        assert found.uncertainty >= 3.0 * last


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
