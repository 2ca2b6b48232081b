"""The model that an accuracy or a time calls for, from measured cost."""

import json

import pytest
from typer.testing import CliRunner

import scenes
from studies.cli import app
from studies.cost.choice import choose
from studies.settings import Settings
from studies.study import Study, StudyError

# name, error (deg/s), wall (s); None is the yardstick, which is trusted to the band of 0.02.
POINTS = [("rigid", 0.9, 0.002), ("rigid fine", 0.85, 0.004), ("compliant", 0.05, 0.003), ("compliant fine", 0.004, 0.006),
          ("4 mm", 0.03, 5.0), ("2 mm", None, 30.0), ("lost", 0.0, 0.001)]


@pytest.fixture
def study(tmp_path):
    scene = scenes.load("tiny")
    points = [{"model": name, "rung": name, "numerics": "-", "setting": 1.0, "error_deg_s": error, "wall_s": wall,
               "status": "diverged" if name == "lost" else "exited"} for name, error, wall in POINTS]
    found = Study(scene, tmp_path / "tiny", Settings())
    found.folder.mkdir()
    found.path("cost_study.json").write_text(json.dumps(
        {"scene_hash": scene.hash, "condition": "phi15", "band_deg_s": 0.02, "points": points}))
    return found


@pytest.mark.parametrize("accuracy, budget, expected", [
    (1.0, None, "rigid"), (0.1, None, "compliant"), (0.03, None, "compliant fine"), (0.02, None, "compliant fine"),
    (None, 0.003, "compliant"), (None, 0.0025, "rigid"), (None, 60.0, "compliant fine"), (0.1, 4.0, "compliant"),
    (0.86, 0.0025, None), (0.01, None, None), (None, 0.0015, None)])
def test_cheapest_or_most_exact(study, accuracy, budget, expected):
    """An error below the band counts as the band: 0.004 deg/s cannot be told from 0.02. A model that diverged never counts."""
    if expected is None:
        with pytest.raises(StudyError, match="no model fits"):
            choose(study, accuracy, budget)
    else:
        found = choose(study, accuracy, budget)
        assert found["rung"] == expected and found["model"] in found["why"] and "phi15" in found["why"]


def test_refusal_names_the_nearest(study):
    with pytest.raises(StudyError) as fault:
        choose(study, 0.1, 0.0025)
    assert "most exact in that time: rigid, - (0.9 deg/s, 0.002 s)" in str(fault.value)
    assert "cheapest that is so exact: compliant, - (0.05 deg/s, 0.003 s)" in str(fault.value)


def test_refusal_of_one_limit_names_the_best_there_is(study):
    with pytest.raises(StudyError, match="most exact of all: compliant fine, - "):
        choose(study, accuracy=0.01)
    with pytest.raises(StudyError, match="fastest of all: rigid, - "):
        choose(study, budget=0.0015)


def test_cost_of_another_scene_is_none(study):
    with pytest.raises(StudyError, match="tipoff cost --scene tiny"):
        choose(Study(study.scene.replace({"payload.mass": "8 kg"}), study.folder, Settings()), 0.1)


@pytest.mark.parametrize("options, words", [
    (["--accuracy", "0.1"], "deg/s"), (["--accuracy", "0.1 m"], "deg/s"), (["--budget", "2 mm"], "a quantity"),
    (["--budget", "-1 s"], "zero or more")])
def test_bad_limits_are_refused(tmp_path, options, words):
    result = CliRunner().invoke(app, ["run", "--scene", "tiny", "--out", str(tmp_path), *options])
    assert result.exit_code == 2 and options[0] in result.stderr and words in result.stderr
