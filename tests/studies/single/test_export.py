"""The option ``--export`` of ``tipoff run`` and ``tipoff ensemble``."""

import json

import pytest
from typer.testing import CliRunner

from tipoff.results import hand_over
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import load
from tipoff.scenes.effects.hand_over import standing
from tipoff.studies.cli import app

ASKED = ["--scene", "tiny", "--model", "springs"]
NORTH = ["--set", "hand_over.heading=30 deg"]


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_the_file_of_a_run_has_the_state_of_its_trajectory(tmp_path):
    """The stored run is the same for another heading, the file is not."""
    run, file = ["run", *ASKED, "--out", tmp_path], tmp_path / "exit.json"
    first = call(*run, "--export", "rocketpy", file)
    assert first.exit_code == 0 and "assumed: inclination 90 deg" in " ".join(first.stderr.split())
    assert json.loads(file.read_text())["heading_deg"] == 0.0
    again = call(*run, *NORTH, "--export", "rocketpy", file, "--json")
    assert again.exit_code == 0 and "heading 0" not in again.stderr
    content, found = json.loads(file.read_text()), json.loads(again.stdout)
    stored = Trajectory.load(tmp_path / "tiny" / found["trajectory"])
    rail = standing(load("tiny").replace({"hand_over.heading": "30 deg"}).resolved())
    expected = hand_over.initial_solution(stored.state_at_exit(), rail)
    assert content["initial_solution"] == pytest.approx(expected.tolist(), rel=1e-14)


def test_the_file_of_an_ensemble_has_mean_and_covariance(tmp_path):
    file = tmp_path / "exits.json"
    asked = ["ensemble", *ASKED, "--cases", 12, "--out", tmp_path, "--export", "rocketpy", file]
    found = call(*asked)
    assert found.exit_code == 0, found.stderr
    content = json.loads(file.read_text())
    assert content["cases"] == 12 and len(content["mean"]) == 14
    assert list(content["covariance_components"]) == list(hand_over.MINIMAL)
    assert [len(row) for row in content["covariance"]] == [len(hand_over.MINIMAL)] * 13


@pytest.mark.parametrize(
    "options, words",
    [
        (["--export", "xml", "exit.xml"], "export: format: given 'xml', expected rocketpy or csv"),
        (
            ["--condition", "phi15,phi35", "--export", "csv", "exit.csv"],
            "--export: conditions: given 2, expected one condition",
        ),
        (
            [
                *("--set", "gravity.x=-9.8 m/s**2", "--set", "hand_over.inclination=80 deg"),
                *("--export", "csv", "exit.csv"),
            ],
            "hand_over.inclination: given 80 deg, expected 90 deg",
        ),
    ],
)
def test_what_is_refused_before_the_run(options, words, tmp_path):
    found = call("run", *ASKED, "--out", tmp_path, *options)
    assert found.exit_code == 2 and words in " ".join(found.stderr.split())
    assert not list(tmp_path.iterdir())
