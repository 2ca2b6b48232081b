"""Runs of the reference in the store are kept while they are made, go on after a kill, and leave
nothing behind (X20)."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.results.trajectory import Trajectory
from tipoff.studies.cli import app
from tipoff.workspace import store as store_module
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

pytestmark = pytest.mark.case("X20")
ROOT = Path(__file__).resolve().parents[2]
RUN = (
    "run",
    "--model",
    "finite-elements",
    "--scene",
    "tiny",
    "--condition",
    "phi15",
    "--set",
    "studies.element_size=8 mm",
)


@pytest.fixture
def asked(monkeypatch):
    """An engine that needs no time: the checkpoint arguments it was given, call by call."""
    calls = []

    def execute(run, progress=None, threads=None, **kept):
        calls.append(kept | {"there": kept["checkpoint"].exists()})
        kept["checkpoint"].parent.mkdir(parents=True, exist_ok=True)
        kept["checkpoint"].write_bytes(b"half of the run")
        return flight()

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    return calls


def study(tmp_path, **settings) -> Study:
    return Study(scenes.load("tiny"), tmp_path / "tiny", Settings(element_size=0.008, **settings))


def test_every_run_of_the_reference_is_kept_beside_its_result_until_that_is_written(
    tmp_path, asked
):
    store, run = study(tmp_path).store, study(tmp_path).highfi("phi15")
    store.get(run)
    assert asked == [
        {
            "checkpoint": store.checkpoint(run),
            "checkpoint_every": 60.0,
            "resume": True,
            "there": False,
        }
    ]
    assert store.checkpoint(run) == store.path(run).with_suffix(".checkpoint")
    assert list(store.path(run).parent.iterdir()) == [store.path(run)]


@pytest.mark.parametrize("resume", [True, False])
def test_what_was_kept_is_taken_up_unless_that_is_not_wanted(tmp_path, asked, capsys, resume):
    it = study(tmp_path, resume=resume, checkpoint_every=5.0)
    path = it.store.checkpoint(it.highfi("phi15"))
    path.parent.mkdir(parents=True)
    path.write_bytes(b"half of the run")
    it.store.get(it.highfi("phi15"))
    assert [(call["there"], call["checkpoint_every"]) for call in asked] == [(resume, 5.0)]
    assert ("phi15 continues from" in capsys.readouterr().err) == resume


def test_damaged_checkpoint_is_named_and_the_run_starts_anew(tmp_path, capsys):
    it = study(tmp_path)
    run = it.highfi("phi15", {"duration": 2e-3})
    path = it.store.checkpoint(run)
    path.parent.mkdir(parents=True)
    path.write_bytes(b"no checkpoint at all")
    assert it.store.get(run).status == "time_limit"
    assert (
        f"{path} has no digest of its content, or a damaged one, so phi15 starts from the beginning"
        in capsys.readouterr().err
    )
    assert not path.exists()


def test_how_a_run_is_kept_is_no_part_of_any_key():
    assert Settings(checkpoint_every=1.0, resume=False).hash == Settings().hash
    assert Settings(element_size=0.001).hash != Settings().hash


@pytest.mark.parametrize(
    "text, words", [("5 m", "a quantity in s"), ("60", "a quantity in s"), ("-1 s", "zero or more")]
)
def test_bad_time_is_bad_input(tmp_path, text, words):
    result = CliRunner().invoke(
        app, [*RUN, "--out", str(tmp_path / "out"), "--checkpoint-every", text]
    )
    assert result.exit_code == 2
    assert "--checkpoint-every" in result.stderr and words in result.stderr
    assert not (tmp_path / "out").exists()


def test_command_line_hands_its_choice_on(tmp_path, asked):
    for number, conditions in enumerate((["--condition", "phi15"], ["--all"])):
        out = ["--out", str(tmp_path / str(number))]
        options = ["--scene", "tiny", "--model", "finite-elements", "--checkpoint-every", "2 min"]
        CliRunner().invoke(app, ["run", *options, *conditions, *out])
    assert len(asked) > 2 and {call["checkpoint_every"] for call in asked} == {120.0}


@pytest.mark.parametrize(
    "density", ["45 g/cm**3", pytest.param("2.81 g/cm**3", marks=pytest.mark.slow)]
)
def test_command_killed_and_given_again_ends_with_the_same_bits(tmp_path, density):
    """The first life is killed once there is a checkpoint; the second one says that it continues from
    there. Heavy rails let steps be long."""
    asked = (*RUN, "--set", f"rail.material.density={density}")
    assert CliRunner().invoke(app, [*asked, "--out", str(tmp_path / "whole")]).exit_code == 0
    killed = ("--out", str(tmp_path / "killed"))
    child = subprocess.Popen(
        [sys.executable, "-m", "tipoff.studies.cli", *asked, *killed, "--checkpoint-every", "0s"],
        cwd=ROOT,
        stderr=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 60.0
    while (
        not list(tmp_path.glob("killed/tiny/highfi/phi15-*.checkpoint"))
        and time.monotonic() < deadline
    ):
        time.sleep(0.01)
    os.kill(child.pid, signal.SIGKILL)
    assert child.wait() == -signal.SIGKILL
    assert not list(tmp_path.glob("killed/tiny/highfi/*.nc"))
    again = CliRunner().invoke(app, [*asked, *killed])
    assert again.exit_code == 0 and (
        "phi15 continues from" in again.stderr and "starts from the beginning" not in again.stderr
    )
    whole, resumed = (
        Trajectory.load(next((tmp_path / name / "tiny" / "highfi").iterdir()))
        for name in ("whole", "killed")
    )
    for name in (
        "velocity",
        "rate",
        "quaternion",
        "pad_force",
        "platform_rate",
        "energy",
        "transverse_energy",
    ):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name), err_msg=name)
    assert len(list((tmp_path / "killed" / "tiny" / "highfi").iterdir())) == 1
