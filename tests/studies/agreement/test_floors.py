"""Runs that are compared for the floor have the same equations."""

from types import SimpleNamespace

import pytest

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.studies.agreement import judging
from tipoff.workspace.settings import defaults
from tipoff.workspace.store import Store
from tipoff.workspace.study import Study


@pytest.mark.parametrize(
    "chosen",
    [
        {"modes": 3, "modes_why": "3 of 20"},
        {"modes": 3, "modes_why": "3 of 20", "degree": 2, "degree_why": "2: ..."},
        {"modes": "auto", "degree": 4},
    ],
)
def test_runs_with_other_clearances_have_the_modes_of_the_nominal_one(
    tmp_path, monkeypatch, chosen
):
    """And its degree of patterns. Control: a nominal run that chose nothing."""
    made = []

    def fill(_store, _title, runs):
        made.extend(runs)
        return [flight(numerics=chosen) for _ in runs]

    monkeypatch.setattr(Store, "fill", fill)
    study = Study(scenes.load("tiny"), tmp_path, defaults("tiny"))
    compliance = SimpleNamespace(hash="0", flexibility=1.0)

    def request(name, **asked):
        return study.lowfi(name, compliance=compliance, **asked)

    judging.floors(study, "compliant", request)
    nominal, *others = made
    assert nominal.numerics.modes == "auto" and len(others) == 2
    expected = chosen["modes"] if "modes_why" in chosen else "auto"
    assert [run.numerics.modes for run in others] == [expected, expected]
    degree = chosen["degree"] if "degree_why" in chosen else None
    assert [run.numerics.degree for run in others] == [degree, degree]
