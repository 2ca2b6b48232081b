"""Points of the cost study on made-up runs: numbers of modes, and the error of time integration."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.lowfi.numerics import AUTO
from tipoff.studies.agreement.candidates import Candidate
from tipoff.studies.cost import stage as cost
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

COMPLIANT = Candidate(
    "compliant",
    "compliant",
    compliance={"phi15": SimpleNamespace(hash="0", flexibility=1.0)},
)


@pytest.fixture
def study(tmp_path):
    return Study(scenes.load("tiny"), tmp_path, defaults("tiny"))


@pytest.fixture
def made(monkeypatch):
    """Made-up runs. Each mode moves the rate about x by 1 deg/s, the tolerance by 10 times itself. A
    loose run that may choose its modes chooses none, a tight one three. Returns the runs that were
    asked for."""
    asked = []

    def run(request, progress=None):
        asked.append(request)
        tolerance, modes = request.numerics.relative_tolerance, request.numerics.modes
        chosen = {"modes": modes}
        if modes == AUTO:
            chosen = {"modes": 0 if tolerance > 1e-3 else 3, "modes_why": "made up"}
        rate = np.radians([chosen["modes"] + 10.0 * tolerance, 0.0, 0.0])
        return flight(lambda t: np.tile(rate, (t.size, 1)), numerics=chosen)

    monkeypatch.setattr(cost, "warm_up", lambda run: None)
    monkeypatch.setattr(cost, "execute", run)
    monkeypatch.setattr(cost, "timed", lambda request: (run(request), 1e-3, 1e-3))
    return asked


def test_the_error_of_time_integration_is_one_of_equal_modes(study, made):
    """Control: the difference of both runs as they are is that of three modes, 2.9 deg/s."""
    tolerances = (1e-2, 1e-4, 1e-6)
    points = cost.surrogate_points(study, "phi15", COMPLIANT, flight(), tolerances)
    assert [point.setting for point in points] == list(tolerances)
    errors = [point.integration_error_deg_s for point in points]
    assert errors[2] is None
    assert errors[:2] == pytest.approx([0.1 - 1e-5, 1e-3 - 1e-5], rel=1e-9)
    loose, _, tight = (point.error_deg_s for point in points)
    assert tight - loose == pytest.approx(2.9, abs=1e-3)
    # one run more: tight, with the modes of the loose one
    (further,) = [run for run in made if run.numerics.modes == 0]
    assert further.numerics.relative_tolerance == 1e-6


def test_runs_of_equal_modes_need_no_further_one(study, made):
    """Control: above, where the modes differ."""
    cost.surrogate_points(study, "phi15", COMPLIANT, flight(), (1e-4, 1e-6))
    assert len(made) == 2 * study.settings.lowfi_repeats


def test_a_rail_without_modes_is_a_point_of_its_own(study, made):
    """Control: the candidate that chooses its modes has none of these numbers."""
    modal = COMPLIANT._replace(name="modal", modes=4)
    points = cost.points_by_modes(study, "phi15", modal, flight())
    assert [(point.modes, point.numerics) for point in points] == [
        (0, "0 modes"),
        (1, "1 mode"),
        (2, "2 modes"),
        (8, "8 modes"),
    ]
    assert [point.error_deg_s for point in points] == pytest.approx([0.0, 1.0, 2.0, 8.0], abs=1e-4)
    assert {run.numerics.modes for run in made} == {0, 1, 2, 8}
    assert 4 in {
        p.modes for p in cost.points_by_modes(study, "phi15", modal._replace(modes=8), flight())
    }
    requests = [COMPLIANT, COMPLIANT._replace(modes=0), modal]
    found = [item.request(study, "phi15") for item in requests]
    assert [run.numerics.modes for run in found] == [AUTO, 0, 4]
    assert len({run.label for run in found}) == 3
