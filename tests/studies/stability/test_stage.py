"""The table of hard cases of the surrogate: every line holds, its control fails, and its step and
drift are real figures."""

from dataclasses import replace

import pytest

from tests.studies.shown import html
from tipoff.studies.stability import contacts, guides, thrusts
from tipoff.studies.stability.page import draw
from tipoff.studies.stability.stage import HardCases

# The scenes of the table compile kernels of their own. `make report` computes the table, and the
# same cases are tests of the surrogate in tests/lowfi.
pytestmark = pytest.mark.slow

CASES = {**contacts.CASES, **guides.CASES, **thrusts.CASES}
# which takes seconds, and is run with the pipeline
CHEAP = [name for name in CASES if name != "turning_platform"]


@pytest.fixture(scope="module")
def verdicts():
    return {name: CASES[name]() for name in CHEAP}


@pytest.mark.parametrize("name", CHEAP)
def test_case_holds_and_its_control_fails(verdicts, name):
    found = verdicts[name]
    assert found.held, found
    assert found.control_failed, found
    assert found.energy_drift <= 1e-6
    if found.critical_step_s is not None:
        assert 0.0 < found.largest_step_s < found.critical_step_s


def test_table_shows_steps_in_microseconds(verdicts):
    page = html(draw(HardCases(tuple(verdicts.values()), ())))
    assert "7.56" in page and "largest step (µs)" in page and page.count("<tr") == len(CHEAP) + 1
    assert page.count('class="good"') == len(CHEAP)


def test_a_case_that_does_not_hold_is_marked(verdicts):
    """Control: one wrong figure, one control that holds too."""
    missed = replace(verdicts["stiff_pad"], held=False)
    useless = replace(verdicts["stiff_pad"], control_failed=False)
    page = html(draw(HardCases((missed, useless), ())))
    assert (
        page.count('class="bad"') == 2
        and "not held" in page
        and "the simpler method holds too" in page
    )
