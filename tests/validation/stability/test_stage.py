"""The table of hard cases of both models: every line holds, its control fails, and its step and
drift are real figures."""

from dataclasses import replace

import pytest

from tests.studies.shown import html
from validation.stability import page
from validation.stability.stage import CASES, HardCases
from validation.stability.verdict import Verdict


def test_there_are_cases_of_both_models():
    assert len(CASES) >= 17


# The scenes of the table compile kernels of their own. `make report` computes the table, and the
# same cases are tests of the surrogate in tests/lowfi.
@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_case_holds_and_its_control_fails(name):
    found = CASES[name]()
    assert found.held, found
    assert found.control_failed, found
    assert found.energy_drift is None or found.energy_drift <= 1e-6
    if found.critical_step_s is not None:
        assert 0.0 < found.largest_step_s < found.critical_step_s


def test_a_case_that_does_not_hold_is_marked():
    """One wrong figure, one control that holds too. Control: a case that holds is marked as good."""
    sound = Verdict("fall", "lowfi", "error", 1e-9, 1e-6, True, "Euler", 1e-2, True)
    missed, useless = replace(sound, held=False), replace(sound, control_failed=False)
    shown = html(page.draw(HardCases((sound, missed, useless), ())))
    assert shown.count('class="bad"') == 2 and shown.count('class="good"') == 1
    assert "not held" in shown and "the simpler method holds too" in shown
