"""Numbers are rounded to their uncertainty."""

import pytest

from tipoff.studies.render.column import Column
from tipoff.uncertain import Measured, below, number, uncertain


@pytest.mark.parametrize(
    "value, uncertainty, shown",
    [
        (-28.458, 13.2, "-28 ± 13"),
        (-28.458, 29.0, "-30 ± 30"),
        (5.0701, 0.113, "5.07 ± 0.11"),
        (5.0701, 0.27, "5.1 ± 0.3"),
        (5.0701, 0.0971, "5.07 ± 0.10"),
        (5.0701, 7.64e-11, "5.070 ± <0.001"),
        (5.0701, 0.0, "5.070 ± <0.001"),
        (-3e-18, 0.02, "0.00 ± 0.02"),
        (12345.6, 210.0, "12,300 ± 200"),
        (1.7712e12, 5.74e10, "1.77e+12 ± 6e+10"),
        (5.07018, 0.001, "5.070 ± 0.001"),
        (5.07018, None, "5.070"),
        (None, 1.0, "–"),
    ],
)
def test_rounding(value, uncertainty, shown):
    assert uncertain(value, uncertainty) == shown


@pytest.mark.parametrize(
    "value, uncertainty, shown",
    [
        (0.013, 0.21, "<0.1"),
        (0.04, 3.2, "<1"),
        (0.6, 3.2, "1"),
        (4.0, 29.0, "<10"),
        (0.0, 0.21, "0.0"),
        (1e-5, 1e-6, "<0.001"),
    ],
)
def test_an_error_below_its_uncertainty_is_not_zero(value, uncertainty, shown):
    assert below(value, uncertainty) == shown
    assert Column("error", "deg/s").measured(Measured(value, uncertainty, magnitude=True)) == shown


def test_a_signed_value_below_its_uncertainty_is_zero():
    assert Column("mean", "deg/s").measured(Measured(0.013, 0.21, apart=True)) == "0.0"


def test_another_least_step():
    assert uncertain(13.6457, 2e-6, 1e-4) == "13.6457 ± <0.0001"


@pytest.mark.parametrize("form", [".4f", "+.3f", ".0f", ",.1f", ".3g", "+.2f"])
def test_a_number_that_rounds_to_zero_has_no_sign(form):
    """Control: Python writes one."""
    for value in (-1e-9, 1e-9, -0.0):
        shown = number(value, form)
        assert not shown.startswith(("-0", "+0")), shown
    if form != ".3g":
        assert format(-1e-9, form).startswith("-0")
    assert number(-1.5, form).startswith("-") and number(-1e-9, ".3g") == "-1e-09"
