"""Which mesh a speed-up is measured against: uncertainties of a series that is known, and the
choice among them."""

from dataclasses import replace

import pytest

from tests.studies.agreement.made import EQUAL
from tipoff.studies.agreement import equal_accuracy

SIZES = (8e-3, 4e-3, 2e-3, 1e-3)
RATES = [
    ([1.4, 1.1, 1.02, 1.0], 0.01),
    ([-2.0, -2.3, -2.31, -2.3], 0.02),
]


def test_mesh_is_as_uncertain_as_the_finest_and_its_way_from_it_on_the_worst_axis():
    assert equal_accuracy.uncertainties(RATES) == pytest.approx([0.41, 0.11, 0.03, 0.02])


@pytest.mark.parametrize("axis", [([1.0, None, 1.0, 1.0], 0.1), ([1.0] * 4, None)])
def test_axis_that_did_not_settle_leaves_all_unknown(axis):
    assert equal_accuracy.uncertainties([*RATES, axis]) is None


@pytest.mark.parametrize(
    "error, mesh",
    [
        (0.5, (8e-3, 0.41)),
        (0.41, (4e-3, 0.11)),
        (0.1, (2e-3, 0.03)),
        (0.025, (1e-3, 0.02)),
        (0.02, (1e-3, 0.02)),
        (0.0, (1e-3, 0.02)),
    ],
)
def test_coarsest_sufficient_mesh_or_the_finest(error, mesh):
    assert equal_accuracy.coarsest(SIZES, [0.41, 0.11, 0.03, 0.02], error) == mesh


def test_speedup_over_an_insufficient_mesh_is_a_lower_bound():
    surer = replace(EQUAL, ratio=5e4, low=4e4, high=6e4)
    least, measured = (replace(surer, surer=False).sentence(), surer.sentence())
    assert (
        "at least 50,000 times (40,000 to 60,000 over repeats): 250 s with the reference, 5 ms with"
        in least
    )
    assert "no mesh down to 1 mm has a smaller uncertainty (0.012 deg/s" in least
    assert "phi35: 50,000 times" in measured and "at least" not in measured
    assert "1 mm is the coarsest mesh with a smaller uncertainty (0.012 deg/s" in measured
