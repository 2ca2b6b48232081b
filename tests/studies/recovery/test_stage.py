"""Recovery of hidden values, small: two draws on the coarse scene, and a reference of 8 mm."""

import pytest

from tests.highfi.support import tiny
from tipoff.studies.core.settings import defaults
from tipoff.studies.core.study import Study, StudyError
from tipoff.studies.recovery import page, stage
from tipoff.studies.render import document


def test_hidden_values_are_found_and_shown(tmp_path):
    study = Study(tiny(), tmp_path / "tiny", defaults("tiny"))
    found = stage.run(study, stage.Options(draws=2))
    assert [row["parameter"] for row in found["rows"]][:2] == list(stage.HIDDEN)
    for row in found["rows"]:
        assert row["covered_with_model_error"] == 2 >= row["covered"] >= 0
        assert row["half_width"] > 0.0
    assert sum(row["covered"] for row in found["rows"]) >= 5
    assert found["held_out"]["fitted_deg_s"] < 0.3 * found["held_out"]["scene_deg_s"]
    for row in found["reference"]["rows"]:
        low, high = row["interval"]
        assert low <= row["hidden"] <= high
    assert found["reference"]["rows"][0]["hidden"] == pytest.approx(0.2625e-3)
    text = document.terminal(page.draw(found))
    assert "contact.clearance" in text and "elements of 8 mm" in text
    assert stage.STAGE.stored(study)["rows"] == found["rows"]


def test_nothing_is_hidden_where_there_is_nothing(tmp_path):
    study = Study(tiny().replace({"friction": "absent"}), tmp_path / "tiny", defaults("tiny"))
    with pytest.raises(StudyError, match="lacks one of them"):
        stage.run(study)
