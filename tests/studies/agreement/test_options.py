"""The number of neighbours that the agreement study takes."""

from dataclasses import replace

import pytest

from tipoff.scenes import load
from tipoff.studies.agreement import stage
from tipoff.studies.agreement.options import CompareOptions
from tipoff.studies.question import Result
from tipoff.studies.report import stage as report
from tipoff.workspace.settings import defaults
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study


@pytest.mark.parametrize(
    "stored, given, taken",
    [(None, None, 5), (128, None, 5), (128, 64, 64), (None, 64, 64)],
)
def test_the_number_is_that_asked_for_or_of_the_settings(
    tmp_path, monkeypatch, stored, given, taken
):
    """Whatever is stored. Control: the page shows what is stored, and makes the rest."""
    study = Study(load("tiny"), tmp_path, defaults("tiny"))
    found = None if stored is None else Made(None, {"asked": {"neighbours": stored}})
    monkeypatch.setattr(stage, "candidates", lambda _: (None,) * 4)
    monkeypatch.setattr(Stage, "stored", lambda *_: found)
    monkeypatch.setattr(
        Stage, "run", lambda own, _, options, make: own.plain(options)["neighbours"]
    )
    options = None if given is None else CompareOptions(neighbours=given)
    assert stage.run(study, options) == taken
    assert stage.current(study) == (stored or 5)


@pytest.mark.parametrize(("of_settings", "taken"), [(32, 8), (5, 5)])
def test_a_first_report_takes_few(tmp_path, monkeypatch, of_settings, taken):
    """Control: with --every it takes those of the settings."""
    settings = replace(defaults("reference"), neighbours=of_settings)
    study = Study(load("reference"), tmp_path, settings)
    monkeypatch.setattr(stage, "candidates", lambda _: (None,) * 4)
    monkeypatch.setattr(Stage, "stored", lambda *_: None)
    monkeypatch.setattr(
        Stage, "run", lambda own, _, options, make: own.plain(options)["neighbours"]
    )
    assert stage.current(study) == taken
    monkeypatch.setattr(report, "results", lambda: [Result("agreement", stage.current)])
    asked = []
    monkeypatch.setattr(stage, "run", lambda study, options=None: asked.append(options))
    for every in (False, True):
        report.run(study, every=every)
    assert asked == [CompareOptions(neighbours=taken), None]
