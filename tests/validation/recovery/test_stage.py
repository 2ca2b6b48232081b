"""Recovery of hidden values, small: two draws on the coarse scene, and a reference of 8 mm."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from tests.highfi.support import tiny
from tests.scenes.test_calibration import CALIBRATION
from tipoff import calibration
from tipoff.studies.render import document
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, StudyError
from validation.recovery import page, stage
from validation.recovery.draws import LOCAL, Draw


@pytest.mark.slow
def test_hidden_values_are_found_and_shown(tmp_path):
    require_hidden_values(tmp_path, draws=2, least=5)


def test_hidden_values_are_found_and_shown_in_one_draw(tmp_path, monkeypatch):
    """What is hidden in the reference is found by least squares alone. Of four intervals that hold
    95 %, three miss once in 2,000 draws."""
    monkeypatch.setattr(calibration, "run", functools.partial(calibration.run, plan=LOCAL))
    require_hidden_values(tmp_path, draws=1, least=2)


def require_hidden_values(tmp_path, draws: int, least: int) -> None:
    study = Study(tiny(), tmp_path / "tiny", defaults("tiny"))
    found = stage.run(study, stage.RecoveryOptions(draws=draws)).document
    assert [row["parameter"] for row in found["rows"]][:2] == list(stage.HIDDEN)
    for row in found["rows"]:
        assert row["covered_with_model_error"] == draws >= row["covered"] >= 0
        assert row["half_width"] > 0.0
    assert sum(row["covered"] + row["undetermined"] for row in found["rows"]) >= least
    assert [row["undetermined"] for row in found["rows"][:2]] == [0, 0]
    assert found["held_out"]["fitted_deg_s"] < 0.3 * found["held_out"]["scene_deg_s"]
    for row in found["reference"]["rows"]:
        low, high = row["interval"]
        assert low <= row["hidden"] <= high
    assert found["reference"]["rows"][0]["hidden"] == pytest.approx(0.2625e-3)
    text = document.terminal(page.draw(found))
    assert "contact.clearance" in text and "elements of 8 mm" in text
    assert "which is held out" in text
    assert stage.STAGE.stored(study).document["rows"] == found["rows"]


def test_a_value_that_is_not_determined_is_not_covered():
    """Without ends an interval contains nothing and has no width. Control: the other draw."""
    endless = [[-np.inf, np.inf]]
    whole = replace(CALIBRATION, parameters=["a"], units=["m"], intervals=[[1.0, 3.0]])
    known = replace(whole, with_model_error=[[0.0, 4.0]])
    lost = replace(whole, intervals=endless, with_model_error=endless)
    draws = [Draw([2.0], one, {}, {}) for one in (known, lost)]
    (row,) = stage.rows(draws)
    assert (row["covered"], row["covered_with_model_error"], row["undetermined"]) == (1, 1, 1)
    assert row["half_width"] == 1.0 and stage.rows(draws[1:])[0]["half_width"] is None


def test_nothing_is_hidden_where_there_is_nothing(tmp_path):
    study = Study(tiny().replace({"friction": "absent"}), tmp_path / "tiny", defaults("tiny"))
    with pytest.raises(StudyError, match="lacks one of them"):
        stage.run(study)
