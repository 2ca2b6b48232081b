"""What a newcomer meets at the command line: help, completion, misspelt names, units, the end of
every command."""

import json

import pytest
import typer
from typer.testing import CliRunner

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.studies.cli import app
from tipoff.studies.commands import options, running


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_version_and_groups():
    from importlib.metadata import version

    assert call("--version").stdout.strip() == f"tipoff {version('tipoff')}"
    shown = call("--help").stdout
    for title in ("Answers", "Surrogate against finite elements", "Studies", "--show-completion"):
        assert title in shown


def test_completion_of_scenes_and_files(tmp_path, monkeypatch):
    (tmp_path / "mine.toml").touch()
    (tmp_path / "notes.txt").touch()
    monkeypatch.chdir(tmp_path)
    assert options.scene_names("ti") == ["tiny", "titanium"]
    assert options.scene_names("m") == ["mine.toml"]
    assert options.scene_names(f"{tmp_path}/") == [f"{tmp_path}/mine.toml"]


@pytest.mark.parametrize(
    "scene, incomplete, names",
    [
        ("tiny", "phi3", ["phi35"]),
        ("tiny", "phi15,phi3", ["phi15,phi35"]),
        ("nowhere", "phi", []),
        (None, "h9", ["h9"]),
    ],
)
def test_completion_of_conditions(scene, incomplete, names):
    given = typer.Context(typer.main.get_command(app))
    given.params = {"scene": scene}
    assert options.condition_names(given, incomplete) == names


@pytest.mark.parametrize("text", ["4 kg", "four", "4", "10 um", "nan", "inf", "-4 mm", ""])
def test_a_bad_element_size(text):
    with pytest.raises(scenes.SceneError, match=r"studies\.element_size"):
        scenes.load("tiny").replace({"studies.element_size": text})


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["run", "--element-size", "4"], '--set studies.element_size="4 mm"'),
        (["cost", "--strict"], "tipoff run --strict"),
        (["flight", "--range=1 km"], "--set flight.range=VALUE"),
        (["measured", "--seed", "3"], "the file of errors states it"),
    ],
)
def test_an_option_that_the_scene_states_is_no_longer_one(arguments, words):
    found = call(*arguments, "--scene", "tiny")
    assert found.exit_code == 2 and words in found.stderr


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--scene", "tny"], ["in the options", "--scene: name: given 'tny'", "mean tiny?"]),
        (["--condition", "phi3"], ["in the options", "--condition", "phi35 or phi0?"]),
        (["--set", "payload.mas=9 kg"], ["in the options", "--set: payload.mas", "payload.mass"]),
        (["--condition", "phi15,phi3"], ["in the options", "'phi3'", "phi35 or phi0?"]),
        (["--set", "mass=9 kg"], ["did you mean payload.mass or thrust.mass or platform.mass?"]),
        (["--set", "contact.clearance=9 kg"], ['for example "0.25 mm"']),
        (["--set", "thrust_offset.misalignment.axial=9 kg"], ['for example "0.1 deg"']),
        (["--set", "pads.3.inset=9 kg"], ['for example "10 mm"']),
    ],
)
def test_a_fault_of_an_option_helps(arguments, words, tmp_path):
    found = call("run", "--scene", "tiny", "--out", tmp_path / "out", *arguments)
    assert found.exit_code == 2 and not (tmp_path / "out").exists()
    assert all(word in found.stderr for word in words), found.stderr


def test_strict_refuses_what_is_implausible(tmp_path, stub):
    stub()
    doubtful = ["run", "--scene", "tiny", "--model", "finite-elements", "--out", tmp_path / "out"]
    doubtful += ["--set", "rail.material.density=2.8 kg/m**3"]
    refused = call(*doubtful, "--strict")
    assert refused.exit_code == 2 and "wave speed" in refused.stderr
    assert not (tmp_path / "out").exists()
    warned = call(*doubtful)
    words = "implausible: rail.material.youngs_modulus, rail.material.density"
    assert warned.exit_code == 0 and warned.stderr.count(words) == 1


def test_a_value_that_a_condition_replaces_is_warned_about(tmp_path, stub):
    stub()
    asked = ["run", "--scene", "tiny", "--model", "finite-elements", "--out", tmp_path]
    asked += ["--set", "thrust_offset.misalignment.radial=10 deg"]
    warned = call(*asked, "--condition", "phi15")
    words = "--set: thrust_offset.misalignment.radial: the conditions phi15 replace this value"
    assert warned.exit_code == 0 and words in " ".join(warned.stderr.split())
    assert "--set conditions.phi15.thrust_offset.misalignment.radial=VALUE" in warned.stderr
    other = call(*asked, "--set", "payload.mass=9 kg")  # the scene itself
    assert other.exit_code == 0 and "replace" not in other.stderr
    own = ["--set", "conditions.phi15.thrust_offset.misalignment.radial=10 deg"]
    changed = call(*asked[:7], *own, "--condition", "phi15")
    assert changed.exit_code == 0 and "replace" not in changed.stderr


@pytest.mark.parametrize(
    "arguments, words",
    [
        (
            ["flight", "--set", "flight.range=5 kg", "--set", "flight.duration=1 m"],
            ["2 faults in the options", "flight.range"],
        ),
        (["calibrate", "--fit", "contact.clearanse"], ["did you mean contact.clearance"]),
        (["ensemble", "--vary", "papr"], ["1 fault in the files", "did you mean paper?"]),
        (["new", "mine", "--mass", "12 m"], ["2 faults in the options", "FILE", "--mass"]),
        (["new", "my launcher.toml"], ["FILE: name", "at most 64 letters"]),
        (["view", "--set", "studies.element_size=4 kg"], ["element_size", 'for example "']),
        (["run", "--budget", "2 kg", "--accuracy", "1"], ["2 faults", '"2 s"', '"0.1 deg/s"']),
        (["new", "mine.toml", "--clearance", "2 s"], ["--clearance", 'for example "0.25 mm"']),
    ],
)
def test_faults_name_the_option(arguments, words, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")  # no message is wrapped
    monkeypatch.chdir(tmp_path)
    scene = [] if arguments[0] == "new" else ["--scene", "tiny"]
    found = call(*arguments, *scene)
    assert found.exit_code == 2 and not list(tmp_path.iterdir())
    assert all(word in found.stderr for word in words), found.stderr


def test_every_result_says_which_units_it_has(tmp_path, stub):
    stub()
    asked = ["run", "--scene", "tiny", "--model", "finite-elements", "--out", tmp_path, "--json"]
    for conditions in (["--all"], ["--condition", "phi15"]):
        found = json.loads(call(*asked, *conditions).stdout)
        assert "rate_deg_s" in found["quantities"] and "SI" in found["quantities"]
    stored = json.loads((tmp_path / "tiny" / "highfi.json").read_text())
    assert stored["quantities"] == found["quantities"]


def test_several_conditions_in_one_command(tmp_path, stub, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")  # no cell of a table is wrapped
    stub()
    asked = ["run", "--scene", "tiny", "--model", "finite-elements", "--out", tmp_path]
    asked += ["--condition", "phi15,h1", "--condition", "phi60"]
    found = json.loads(call(*asked, "--json").stdout)
    assert [row["condition"] for row in found["conditions"]] == ["phi15", "h1", "phi60"]
    shown = call(*asked).stdout
    assert "tiny / h1" in shown and "rate x (deg/s)" in shown


def test_a_stage_ends_with_a_table_and_its_files_also_when_nothing_changed(
    tmp_path, stub, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "200")  # no cell of a table is wrapped
    stub()
    asked = ["run", "--all", "--model", "finite-elements", "--scene", "tiny", "--out", tmp_path]
    first, second = call(*asked), call(*asked)
    assert first.stdout == second.stdout and "nothing changed" in second.stderr
    assert "off axis (deg)" in first.stdout and "phi15" in first.stdout
    assert str(tmp_path / "tiny" / "highfi.json") in first.stdout


def test_files_of_a_stage(tmp_path):
    result = {"scene": "mine", "stage": "highfi", "files": {"a.csv": "", "b/1": "", "b/2": ""}}
    place = tmp_path / "mine"
    assert running.files(result, tmp_path) == [
        f"  {place / name}" for name in ("highfi.json", "a.csv", "b/1", "b/2")
    ]
    result["files"] |= {"b/3": "", "b/4": ""}
    assert running.files(result, tmp_path)[-1] == f"  {place / 'b'}/ (4 files)"


def test_a_run_that_ends_too_early_is_no_success(tmp_path, stub):
    stub(status="time_limit", outcome=flight().outcome._replace(rate=None, velocity=None))
    for conditions in (["--all"], ["--condition", "phi15"]):
        asked = ["run", "--scene", "tiny", "--model", "finite-elements", "--out", tmp_path]
        found = call(*asked, *conditions)
        assert found.exit_code == 1
        assert "phi15: time_limit: " in found.stderr and "duration of" in found.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["calibrate", "--reference", "phi15=missing.csv"],
        ["ensemble", "--table", "missing.csv"],
        ["ensemble", "--vary", "missing.toml"],
        ["measured", "missing.toml"],
        ["sensitivity", "--vary", "missing.toml"],
        ["run", "--calibration", "missing.toml"],
    ],
)
def test_files_are_looked_for_before_anything_is_computed(arguments, tmp_path):
    found = call(*arguments, "--scene", "tiny", "--out", tmp_path / "out")
    assert found.exit_code == 2 and "1 fault in the files" in found.stderr
    assert "missing" in found.stderr and not (tmp_path / "out").exists()
