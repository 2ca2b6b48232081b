"""The table of hard cases of the surrogate: every line holds, its control fails, and its step and
drift are real figures."""

from dataclasses import replace

import pytest

from tests.studies import kept
from tests.studies.shown import html
from tipoff.studies.stability import contacts, guides, page, thrusts
from tipoff.studies.stability.stage import STAGE, HardCases

CASES = {**contacts.CASES, **guides.CASES, **thrusts.CASES}
# which takes seconds, and is run with the pipeline
CHEAP = [name for name in CASES if name != "turning_platform"]


# The scenes of the table compile kernels of their own. `make report` computes the table, and the
# same cases are tests of the surrogate in tests/lowfi.
@pytest.mark.slow
@pytest.mark.parametrize("name", CHEAP)
def test_case_holds_and_its_control_fails(name):
    found = CASES[name]()
    assert found.held, found
    assert found.control_failed, found
    assert found.energy_drift <= 1e-6
    if found.critical_step_s is not None:
        assert 0.0 < found.largest_step_s < found.critical_step_s


def test_a_case_that_does_not_hold_is_marked():
    """One wrong figure, one control that holds too. Control: a case that holds is marked as good."""
    sound, *_ = kept.result(STAGE).cases
    missed, useless = replace(sound, held=False), replace(sound, control_failed=False)
    shown = html(page.draw(HardCases((sound, missed, useless), ())))
    assert shown.count('class="bad"') == 2 and shown.count('class="good"') == 1
    assert "not held" in shown and "the simpler method holds too" in shown
