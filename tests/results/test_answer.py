"""The answer of a run: the terminal, the result file and Python say the same, with the rates by hand where they
are valid and each button."""

import json
import math
import re

import pytest

import tipoff
from tipoff.results import answer
from tipoff.results.model_error import ModelError
from tipoff.scenes.names import NOMINAL
from tipoff.studies.single import single
from tipoff.studies.single.text import Detail
from tipoff.workspace import models
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

AT_EXIT = ", at the exit"
_LINE = re.compile(r"\s*(by hand|at exit|burnt out|button \d|\S+)\s+(.*)")


def lines(text):
    """The text of each line by its title."""
    return dict(found.groups() for line in text.splitlines() if (found := _LINE.match(line)))


@pytest.fixture(scope="module")
def rocket():
    return tipoff.load("rocket_rail")


@pytest.mark.parametrize("detail", [Detail.ANSWER, Detail.ALL])
def test_a_rocket_has_its_rates_by_hand_and_its_buttons_everywhere(
    rocket, tmp_path, capsys, detail
):
    """The pin and the buttons, without being asked for. Control: why the settled rates have no such answer is a
    detail."""
    options = models.ModelOptions("springs")
    made = single.run(Study(rocket, tmp_path, Settings(workers=1)), NOMINAL, options, detail)
    printed = capsys.readouterr().out
    assert ("by hand       not valid: " in printed) is (detail == Detail.ALL)
    run = tipoff.run(rocket, "springs")
    (hand,) = run.by_hand
    rates = [math.degrees(rate) for rate in hand.rate_rad_s]
    assert json.loads(json.dumps(made))["by_hand_at_exit"]["rate_deg_s"] == pytest.approx(rates)
    summary = lines(run.summary())
    for shown in (summary, lines(printed)):
        assert "leaves at 261.5 ms, 14.9" in shown["button 1"]
        assert "N m at its foot" in shown["button 2"]
        assert (
            shown["velocity"] == summary["velocity"] and shown["rate"] in summary["rate"] + AT_EXIT
        )
        assert shown["direction"] == summary["direction"]
    told = answer.rates(rates)
    assert (
        summary["by hand"].startswith(told) and f"by hand       {told}: a rigid rocket" in printed
    )
    for own, row in zip(run.guides, made["guides"], strict=True):
        assert row["leaves_s"] == pytest.approx(own.leaves_s)
        assert row["moment_n_m"] == pytest.approx(own.moment_n_m)


def test_a_free_payload_has_moment_over_inertia(tmp_path, capsys):
    free = tipoff.load("tiny").replace({"contact": None, "friction": None})
    single.run(Study(free, tmp_path, Settings(workers=1)), NOMINAL)
    run = tipoff.run(free)
    (hand,) = run.by_hand
    assert hand.at == "settled" and hand.rate_rad_s == pytest.approx(run.outcome.rate, abs=2e-3)
    for text in (capsys.readouterr().out, run.summary()):
        assert "moment impulse over inertia, no pad touches" in text


def test_a_run_in_python_says_its_numbers_and_their_error():
    """Those of the command: the rates with their error, the elements of the rail, modes, cells, tolerance.
    Control: springs have neither elements nor modes."""
    run = tipoff.run(tipoff.load("tiny").condition("phi15"))
    summary = lines(run.summary())
    own = answer.words(
        run.outcome.velocity, [math.degrees(rate) for rate in run.outcome.rate], run.error
    )
    assert summary["rate"] == own["rate"] and " ± " in own["rate"]
    modes = run.numerics["modes"]
    expected = f"rail of 8 mm elements, {modes} modes of each rail, 16 contact cells along each edge of a pad"
    assert summary["numerics"] == f"{expected}, tolerance 2e-07"
    assert run.numerics["rail_compliance"]["uncertainty"] > 0.1
    other = tipoff.run(tipoff.load("tiny").condition("phi15"), "springs", sensitivity=False)
    assert lines(other.summary())["numerics"] == "tolerance 2e-07" and not other.error


def test_rates_are_rounded_to_their_error():
    velocity, rate = (6.06371, -0.00694, -0.0036), (-4.3867, -1.4991, 3.5762)
    error = ModelError(parts_deg_s={"rail mesh": 0.018})
    said = answer.words(velocity, rate, error)
    assert said["rate"] == "-4.387, -1.499, 3.576 ± 0.018 deg/s (x, y, z), 5.855 in total"
    unknown = answer.words(velocity, rate, None)
    assert unknown["rate"] == "-4.387, -1.499, 3.576 deg/s (x, y, z), 5.855 in total"
    assert unknown["velocity"] == "6.0637, -0.0069, -0.0036 m/s (x, y, z)"
