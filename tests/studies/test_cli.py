"""The command line: exit codes and what it says about bad input. Nothing is written when the input
is bad."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from tests.written_names import RUN_ROW
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import CATALOG, load
from tipoff.studies.cli import RENAMED, app, flowed
from tipoff.studies.report import assembly
from tipoff.studies.report.page import Page
from tipoff.studies.runs.figures import Runs

ROOT = Path(__file__).resolve().parents[2]
PARAMETERS = {
    name: {item.name for item in command.params}
    for name, command in typer.main.get_command(app).commands.items()
}
ONE = ("run", "--model", "finite-elements", "--condition", "phi15")
HIGHFI = ("run", "--model", "finite-elements", "--all")
STAGES = [name for name, given in PARAMETERS.items() if "scene" in given]


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.mark.parametrize(
    "overrides, words",
    [
        (["payload.mass=9.9 m"], ["payload.mass", "9.9 m", "kg"]),
        (["payload.weight=9.9 kg"], ["payload.weight", "no such key"]),
        (
            [
                "payload.mass=-1 kg",
                "rail.material.density=0 kg/m**3",
                "rail.material.poisson_ratio=0.5",
            ],
            ["payload.mass", "rail.material.density", "rail.material.poisson_ratio", "3 faults"],
        ),
        (["payload.mass"], ["--set", "KEY=VALUE"]),
        (["contact.clearance=-0.1 mm"], ["contact.clearance"]),
    ],
)
def test_bad_override_lists_every_fault_and_writes_nothing(tmp_path, overrides, words):
    options = [part for item in overrides for part in ("--set", item)]
    result = call(*HIGHFI, "--scene", "tiny", "--out", tmp_path / "out", *options)
    assert result.exit_code == 2
    assert all(word in result.stderr for word in words)
    assert "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_refuses_an_unknown_scene(tmp_path, stage):
    result = call(stage, "--scene", "no_such_scene", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "no_such_scene" in result.stderr and "reference" in result.stderr
    assert not (tmp_path / "out").exists()


OWN_SECTION = """extends = "tiny"
[rail]
section = [["0 mm", "0 mm"], ["20 mm", "0 mm"], ["20 mm", "20 mm"], ["0 mm", "20 mm"]]
start = "-88 mm"
end = "132 mm"
mounts = [{ start = "0 mm", end = "20 mm" }]
mounted = [["10 mm", "0 mm"]]
material = { density = "2700 kg/m**3", youngs_modulus = "70 GPa", poisson_ratio = 0.33 }
"""


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_refuses_pads_without_a_wall(tmp_path, stage):
    """Springs do not need the drawing, and did not look at it."""
    (tmp_path / "own.toml").write_text(OWN_SECTION)
    result = call(stage, "--scene", tmp_path / "own.toml", "--out", tmp_path / "out")
    assert result.exit_code == 2 and "Traceback" not in result.output
    assert "own: pads.0: given a face " in result.stderr and "without a wall" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_refuses_pads_on_the_fillet(tmp_path, stage):
    """Also where one condition alone has it."""
    (tmp_path / "wide.toml").write_text(
        'extends = "tiny"\n[conditions.wide]\nrail.fillet = "4.5 mm"\n'
    )
    result = call(stage, "--scene", tmp_path / "wide.toml", "--out", tmp_path / "out")
    assert result.exit_code == 2 and "wide: rail.fillet: given" in result.stderr


@pytest.mark.parametrize("stage", [name for name in STAGES if "condition" in PARAMETERS[name]])
def test_every_stage_refuses_an_unknown_condition(tmp_path, stage):
    result = call(stage, "--scene", "tiny", "--condition", "phi99", "--out", tmp_path / "out")
    assert result.exit_code == 2 and "phi99" in result.stderr and "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", RENAMED)
def test_a_former_name_of_a_command_is_refused_with_the_present_one(name):
    """Control: another unknown name has no such advice."""
    said = call(name, "--json")
    words = " ".join(said.output.replace("│", " ").split())
    assert said.exit_code == 2 and f"it is tipoff {RENAMED[name]} now" in words
    now = RENAMED[name].split()
    assert now[0] in PARAMETERS
    assert " now" not in call("drop").output


def test_scene_without_fitted_conditions_cannot_be_calibrated(tmp_path):
    result = call(
        "calibrate", "--scene", "tiny", "--set", "agreement=absent", "--out", tmp_path / "out"
    )
    assert result.exit_code == 2
    assert "agreement.fitted" in result.stderr
    assert not (tmp_path / "out").exists()


def test_failed_run_is_exit_code_1_with_its_status(tmp_path, stub):
    stub(status="diverged", message="energy grew")
    result = call(*HIGHFI, "--scene", "tiny", "--out", tmp_path)
    assert result.exit_code == 1
    assert "phi15: diverged: energy grew" in result.stderr
    assert (
        json.loads((tmp_path / "tiny" / "highfi.json").read_text())["conditions"][0]["settled"]
        is None
    )


def test_json_is_the_stage_file_on_standard_output(tmp_path, stub):
    stub()
    result = call(
        *HIGHFI,
        "--scene",
        "tiny",
        "--json",
        "--out",
        tmp_path,
    )
    assert result.exit_code == 0
    printed = json.loads(result.stdout)
    assert printed == json.loads((tmp_path / "tiny" / "highfi.json").read_text())
    assert [row["condition"] for row in printed["conditions"]] == ["phi15", "phi60", "h1", "h2"]
    keys = RUN_ROW | {"elements", "ns_per_element_step", "ns_per_element_stepped"}
    assert all(keys <= set(row) for row in printed["conditions"])
    assert set(printed["conditions"][0]["settled"]) >= {"velocity_m_s", "rate_deg_s"}
    assert (
        Trajectory.load(tmp_path / "tiny" / printed["conditions"][0]["trajectory"]).status
        == "exited"
    )


def test_run_prints_the_outcome_with_units(tmp_path, stub):
    stub()
    result = call(
        "run",
        "--scene",
        "tiny",
        "--condition",
        "phi15",
        "--model",
        "finite-elements",
        "--out",
        tmp_path,
    )
    assert result.exit_code == 0
    assert "tiny / phi15, model finite-elements, 8 mm: exited" in result.stdout
    assert "m/s (x, y, z)" in result.stdout and "deg/s (x, y, z)" in result.stdout


def test_an_implausible_thrust_is_said_once_stored_and_on_the_page(tmp_path, stub, monkeypatch):
    """A load cell that reads 40 N without thrust, of 36 kN for 1.5 ms over 3 s. Control: the baseline."""
    stub()
    monkeypatch.setattr("tipoff.studies.report.page.to_files", lambda *_: [])
    time = np.concatenate([np.linspace(0.0, 2e-2, 201), np.linspace(3e-2, 3.0, 298)])
    force = 36e3 * np.exp(-0.5 * ((time - 1.2e-2) / 1.0e-3) ** 2) + 40.0
    rows = "".join(f"{t!r},{f!r}\n" for t, f in zip(time.tolist(), force.tolist()))
    (tmp_path / "thrust.csv").write_text("time_s,force_N\n" + rows)
    own = tmp_path / "own.toml"
    thrust = 'kind = "measured"\nfile = "thrust.csv"\n'
    text = 'extends = "tiny"\nname = "own"\nduration = "3100 ms"\n[thrust]\n' + thrust
    own.write_text(text)
    asked = ["--scene", own, "--out", tmp_path]
    said = "implausible: thrust.baseline: the force does not return to zero: 40 N"
    for command in (ONE, HIGHFI):
        found = call(*command, *asked, "--json")
        assert " ".join(found.stderr.split()).count(said) == 1, found.stderr
        (words,) = [w for w in json.loads(found.stdout)["implausible"] if "baseline" in w]
        assert "this adds 120 N s" in words
    stored = json.loads((tmp_path / "own" / "highfi.json").read_text())
    assert words in stored["implausible"]
    acted = stored["conditions"][0]["thrust"]
    assert acted["impulse_requested_Ns"] == pytest.approx(np.trapezoid(force, time), rel=1e-12)
    shown = call(*ONE, *asked, "--explain").stdout
    assert f"impulse requested {np.trapezoid(force, time):.7g} N s" in shown
    assert f"relative residual {acted['fit_relative_residual']:.3g}" in shown
    short = call(*HIGHFI, *asked, "--set", "duration=30 ms")  # the offset counts as thrust
    assert short.exit_code == 2 and said in " ".join(short.stderr.split())
    html = assembly.render(Page(load(str(own)), tmp_path, {}, Runs({}, {}), {}))
    assert html.count("Implausible: thrust.baseline") == 1
    own.write_text(text + 'baseline = ["40 N", "40 N"]\n')
    found = call(*HIGHFI, *asked, "--json")
    assert "thrust.baseline" not in found.stderr
    assert json.loads(found.stdout)["implausible"] == []


def test_catalogue_is_listed():
    result = call("scenes", "--json")
    assert result.exit_code == 0
    assert {"reference", "sensitive", "tiny"} <= set(json.loads(result.stdout)["scenes"])


def test_real_process_has_no_traceback_and_answers_help_at_once(tmp_path):
    bad = subprocess.run(
        [
            sys.executable,
            "-m",
            "tipoff.studies.cli",
            "view",
            "--mesh",
            "--set",
            "payload.mass=nan kg",
            "--out",
            str(tmp_path / "out"),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert bad.returncode == 2
    assert "payload.mass" in bad.stderr and "Traceback" not in bad.stderr
    assert not (tmp_path / "out").exists()
    answer = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "tipoff.studies.cli", "--help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert answer.returncode == 0
    assert all(stage in answer.stdout for stage in STAGES)
    imported = set(re.findall(r"[|] +(\w+)\n", answer.stderr))
    assert {"typer", "tipoff"} <= imported
    slow = {"gmsh", "matplotlib", "numba", "numpy", "pandas", "pint", "scipy", "xarray"}
    assert not imported & slow


def test_help_flows_but_examples_keep_their_lines():
    assert flowed("First line.\n\nSome prose\nthat goes on.\n\n  [table]\n  key = 1\n") == (
        "First line.\n\nSome prose that goes on.\n\n  [table]\n  key = 1"
    )


def test_a_scene_of_the_catalogue_is_shown_as_it_is_written():
    assert (
        CliRunner().invoke(app, ["scenes", "--show", "tiny"]).stdout
        == (CATALOG / "tiny.toml").read_text()
    )
    refused = CliRunner().invoke(app, ["scenes", "--show", "nowhere"])
    assert refused.exit_code == 2 and "reference" in refused.stderr
