"""What the page and the terminal say of the scene itself."""

from dataclasses import replace

import numpy as np
import pytest

from tests.studies import kept
from tests.studies.shown import html
from tests.studies.synthetic import COSTS, flight
from tipoff.results.model_error import Range as NeighbourRange
from tipoff.studies.nominal import page, spread
from tipoff.studies.nominal.spread import Range
from tipoff.studies.nominal.stage import STAGE, answer
from tipoff.studies.render.document import terminal
from tipoff.studies.runs.results import ConditionRun
from tipoff.studies.runs.stage import row

KEPT = kept.result(STAGE)
LOW = {"rate_deg_s": 0.4123, "rate_x_deg_s": -4.0}


def answered(*rate) -> dict:
    """The answer of a run with this settled rate (deg/s)."""
    outcome = flight().outcome._replace(
        rate=np.radians(rate).tolist(), velocity=[13.64567, 0.1, 0.0], exit_time=0.0123
    )
    return answer(row("nominal", flight(outcome=outcome, cost=COSTS), ""), "settled")


def ends(name) -> Range:
    low = LOW.get(name, 1.0)
    return Range(low=low, high=10.4, low_bounds=(low, low + 0.4), high_bounds=(10.0, 10.4))


def ended(*statuses) -> tuple[ConditionRun, ...]:
    """Runs of both models with these statuses."""
    return tuple(replace(one, status=status) for one, status in zip(KEPT.rows, statuses))


@pytest.fixture
def found():
    ranges = {item.name: ends(item.name) for item in spread.QUANTITIES}
    answers = {
        "finite-elements": answered(-2.0, 1.0, 2.0),
        "compliant": answered(-2.0, 1.25, 2.0),
    }
    return replace(KEPT, answer=answers, spread=replace(KEPT.spread, ranges=ranges))


def test_each_number_has_its_unit_its_meaning_and_its_range(found):
    """A value has no more digits than a fiftieth of its range."""
    shown = page.figures(found)
    assert shown[0] == ("3.0 deg/s", "total rate; 95 % of launches: 0.4 to 10.4 deg/s")
    assert shown[1] == ("-2.0 deg/s", "rate about X, roll; 95 % of launches: -4.0 to 10.4 deg/s")
    values = [value for value, _ in shown[2:]]
    assert values == ["1.00 deg/s", "2.00 deg/s", "13.65 m/s", "12.30 ms"]


def test_a_sensitive_scene_is_the_range_of_its_neighbours(found):
    """In place of its values. Control: the time of the exit, which neighbours do not have."""
    own = NeighbourRange(
        low_deg_s=(-3.0, 0.0, 2.0),
        high_deg_s=(0.0, 0.0, 4.0),
        low_m_s=(13.6, 0.0, 0.0),
        high_m_s=(13.7, 0.0, 0.0),
        off_axis_deg=(0.0, 0.0),
        across_m_s=(0.0, 0.0),
        runs=2,
        lost=0,
        rates_deg_s=((-3.0, 0.0, 4.0), (0.0, 0.0, 2.0)),
    )
    reference, surrogate = found.rows
    sensitive = replace(found, rows=(reference, replace(surrogate, range=own)))
    values = [value for value, _ in page.figures(sensitive)]
    assert values[:2] == ["2.00 to 5.00 deg/s", "-3.00 to 0.00 deg/s"]
    assert values[4:] == ["13.600 to 13.700 m/s", "12.30 ms"]
    said = html(page.draw(sensitive))
    assert "the range of 2 runs within 1 µm of clearance" in said and "at most 0.25" not in said


def test_what_the_numbers_are_is_said(found):
    said = html(page.draw(found))
    assert "The scene itself, by finite elements" in said and "at most 0.25 deg/s" in said
    assert "4,000 launches of compliant contact with the errors paper (thrust_offset.misali" in said
    assert "mass_offset.eccentricity 0 to 0.258 mm)" in said  # half normal below 3 sd of 0.1333
    assert "The ends of the rates are known to ± 3 % of the range or better" in said
    lines = terminal(page.draw(found)).splitlines()
    total = " ".join(lines[0].split())
    assert total == "3.0 deg/s total rate; 95 % of launches: 0.4 to 10.4 deg/s"
    assert len(lines) == 10 and "velocity along X; 95 % of launches: 1.00 to 10.40" in lines[4]


def test_rates_of_a_motor_that_burns_on_are_those_at_the_exit(found):
    """Those after burnout are those of the thrust. Control: the settled ones of the same runs differ."""
    outcome = flight().outcome._replace(
        rate=np.radians([9.0, 9.0, 9.0]).tolist(),
        velocity=[30.0, 0.0, 0.0],
        exit_time=0.0123,
        exit_rate=np.radians([0.0, 3.0, 4.0]).tolist(),
        exit_velocity=[6.0, 0.0, 0.0],
    )
    burning = row("nominal", flight(outcome=outcome, cost=COSTS), "")
    at_exit, settled = (answer(burning, at) for at in ("exit", "settled"))
    assert at_exit["rate_deg_s"] == pytest.approx(5.0) and at_exit["velocity_x_m_s"] == 6.0
    assert settled["rate_deg_s"] == pytest.approx(9.0 * 3.0**0.5)
    answers = dict.fromkeys(found.answer, at_exit)
    spread_ = replace(found.spread, at="exit")
    shown = replace(found, answer=answers, spread=spread_, at="exit", at_why="because it burns on")
    said = html(page.draw(shown))
    assert "after the exit, because it burns on, rates inertial" in said and "burnout" not in said
    assert ", at the exit.</li><li>The ends of" in said


def test_without_errors_no_range_is_claimed(found):
    found = replace(found, spread=None)
    assert page.figures(found)[0] == ("3.00 deg/s", "total rate")
    assert "no range is known" in html(page.draw(found))


def test_a_run_that_does_not_settle_is_no_number(found):
    found.answer["finite-elements"] = None
    found = replace(found, rows=ended("jammed", "exited"))
    said = html(page.draw(found))
    assert "The scene itself, by compliant contact" in said
    assert "The run of finite-elements did not settle: jammed" in said
    found.answer["compliant"] = answer(replace(found.rows[0], settled=None), "settled")
    found = replace(found, rows=ended("jammed", "time_limit"))
    assert page.figures(found)[0][0] == "–"
    assert (
        "does not settle (finite-elements: jammed, compliant: time_limit)" in page.notes(found)[0]
    )
