"""Results that another version of the program wrote: their digest fits, and they lack what this one
reads."""

import json

import pytest

from tipoff import scenes
from tipoff.files import write_json
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, picked


@pytest.fixture
def study(tmp_path):
    return Study(scenes.load("tiny"), tmp_path, defaults("tiny"))


def test_constants_of_another_layout_are_none(study, capsys):
    write_json(study.path("calibration.json"), {"constants": 3.0})
    with pytest.raises(KeyError):
        calibrate.constants(study)
    assert "another version" in capsys.readouterr().err


@pytest.mark.parametrize("listed", [[], "a", {"a\0b": "0"}, {"none": "0"}], ids=json.dumps)
def test_a_stage_whose_files_are_listed_otherwise_is_made_again(study, listed):
    write_json(study.path("mesh.json"), {"key": "its key", "files": listed})
    made = study.stage("mesh", "its key", lambda: ({"made": "again"}, []))
    assert made["made"] == "again"


def test_what_is_damaged_or_missing_is_not_picked(tmp_path):
    path = tmp_path / "some.json"
    assert picked(path, lambda found: found["a"]) is None
    write_json(path, {"a": 1})
    assert picked(path, lambda found: found["a"]) == 1
    path.write_text(path.read_text().replace("1,", "2,"))
    assert picked(path, lambda found: found["a"]) is None
