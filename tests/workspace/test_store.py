"""Results are kept by content: nothing unchanged is run again, nothing changed or damaged is
reused, nothing is half written."""

import errno
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import highfi, lowfi, scenes, sources
from tipoff.calibration import rail_compliance
from tipoff.results.trajectory import Trajectory
from tipoff.workspace import store as store_module
from tipoff.workspace.run import Run
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, StudyError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def engine(monkeypatch):
    """A reference that needs no time: counts its calls and settles at 0.1 rad/s."""
    calls = []

    def execute(run, progress=None, threads=None, **kept):
        calls.append(run.label)
        if progress:
            progress(0.5)
        return flight(lambda t: np.full((t.size, 3), 0.1))

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    return calls


@pytest.fixture
def study(tmp_path):
    return Study(scenes.load("tiny"), tmp_path / "tiny", Settings(workers=2))


def test_second_call_runs_nothing(engine, study):
    names = list(study.conditions)[:4]
    runs = [study.highfi(name) for name in names]
    first = study.store.fill("highfi", runs)
    second = study.store.fill("highfi", runs)
    assert sorted(engine) == sorted(names)
    assert all(np.array_equal(a.rate, b.rate) for a, b in zip(first, second))


@pytest.mark.parametrize(
    "change",
    [
        lambda study: study.highfi("phi15", {"contact.clearance": 6e-5}),
        lambda study: study.highfi("phi15", element_size=0.003),
        lambda study: study.highfi("phi15", safety=0.5),
        lambda study: study.highfi("phi60"),
    ],
)
def test_every_input_is_part_of_the_key(study, change):
    assert change(study).key != study.highfi("phi15").key


def test_sources_are_part_of_the_key(study, monkeypatch):
    before = study.highfi("phi15").key
    monkeypatch.setattr(sources, "digest", lambda *modules, **without: "another program")
    assert study.highfi("phi15").key != before


def keys(study) -> list[str]:
    """Of a run of either model, of a rail compliance, and of a stage."""
    walls = rail_compliance.kept_file(study.scene, study.folder, 8e-3)
    stage = study.key("tipoff.scenes.scene")
    return [study.highfi("phi15").key, study.lowfi("phi15").key, walls.name, stage]


@pytest.fixture
def other_version(monkeypatch):
    """Installs another version of a library."""
    installed = sources.version

    def install(library):
        monkeypatch.setattr(
            sources, "version", lambda name: "0" if name == library else installed(name)
        )

    return install


@pytest.mark.parametrize("library", sources.LIBRARIES)
def test_libraries_are_part_of_every_key(study, other_version, library):
    """They may change the last bits. Controls: one that no number depends on; the generator of meshes,
    for rails that it does not mesh."""
    before = keys(study)
    for beside in ("matplotlib", "gmsh"):
        other_version(beside)
        assert keys(study) == before
    other_version(library)
    assert not set(keys(study)) & set(before)


def test_the_generator_of_meshes_is_part_of_the_keys_of_solids(tmp_path, study, other_version):
    (tmp_path / "rail.step").touch()
    own = study.scene.rail
    box = {"low": [0.0, 0.0, 0.0], "high": [1.0, 1.0, 1.0]}
    rail = {
        **{"geometry": str(tmp_path / "rail.step"), "start": own.start, "end": own.end},
        **{"material": own.material.model_dump(), "surfaces": {"contact": [box], "mount": [box]}},
    }
    solid = replace(
        study, scene=study.scene.replace({"conditions": None, "agreement": None, "rail": rail})
    )
    scene = solid.scene

    def keys():
        runs = [
            Run("highfi", "a", scene, highfi.Numerics()),
            Run("lowfi", "a", scene, lowfi.Numerics()),
        ]
        return [solid.key("tipoff.scenes.scene"), *(run.key for run in runs)]

    before = keys()
    other_version("gmsh")
    assert [new == old for new, old in zip(keys(), before)] == [False, False, True]


def test_label_is_no_part_of_the_key(study):
    assert study.highfi("phi15", tag="-again").key == study.highfi("phi15").key


def test_one_failing_run_stops_the_rest_and_keeps_what_is_finished(study, monkeypatch):
    def execute(run, progress=None, threads=None, **kept):
        if run.label == "h2":
            raise RuntimeError("out of memory")
        return flight()

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    runs = [study.highfi(name) for name in study.conditions]
    with pytest.raises(RuntimeError, match="out of memory"):
        study.store.fill("highfi", runs)
    assert study.store.path(runs[0]).is_file()
    assert not study.store.path(runs[-1]).exists()


def test_ctrl_c_ends_running_kernels(study, monkeypatch):
    """The callback of a running kernel raises, so that no run goes on for minutes after the user
    has stopped."""
    ended = []

    def execute(run, progress=None, threads=None, **kept):
        try:
            while True:
                progress(0.1)
                time.sleep(0.01)
        finally:
            ended.append(run.label)

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    monkeypatch.setattr(store_module, "as_completed", _interrupted)
    with pytest.raises(KeyboardInterrupt):
        study.store.fill("highfi", [study.highfi("phi15"), study.highfi("phi60")])
    deadline = time.monotonic() + 10.0
    while len(ended) < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert sorted(ended) == ["phi15", "phi60"]
    assert not list(study.folder.rglob("*.nc"))


def _interrupted(pending):
    time.sleep(0.1)
    raise KeyboardInterrupt


def test_stage_is_skipped_when_unchanged_and_made_again_when_a_file_was_altered(study):
    made = []

    def make():
        made.append(1)
        path = study.path("table.txt")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("42")
        return {"value": 42}, [path]

    assert study.stage("table", "key", make)["value"] == 42
    assert study.stage("table", "key", make)["value"] == 42
    assert len(made) == 1
    study.path("table.txt").write_text("43")
    study.stage("table", "key", make)
    study.stage("table", "another key", make)
    study.path("table.json").write_text('{"key": "another key"')
    study.stage("table", "another key", make)
    assert len(made) == 4


def test_settings_and_roles_change_a_stage_key_and_workers_do_not(study):
    def key(**change):
        return Study(
            **{"scene": study.scene, "folder": study.folder, "settings": study.settings} | change
        ).key("tipoff.scenes.scene")

    assert key(settings=Settings(workers=7)) == key()
    assert key(settings=Settings(element_size=0.001)) != key()
    assert key(scene=study.scene.replace({"agreement.fitted": ["phi15"]})) != key()
    assert key(scene=study.scene.replace({"payload.mass": "9 kg"})) != key()


MOMENTS = (0.0, 0.001, 0.002, 0.003, 0.005, 0.007, 0.009, 0.012)  # s after a small file was written
# The bytes are made once, so that the loop hardly does anything but write.
KILLED = """
import os, sys
from tests.studies.synthetic import flight
from tipoff.results import trajectory
run = flight(samples=int(sys.argv[1]))
content = trajectory.content(run)
trajectory.content = lambda _: content
for path in sys.argv[2:]:  # a process each
    child = os.fork()
    while child == 0:
        run.save(path)
        print(os.getpid(), flush=True)
    os.waitpid(child, 0)
"""


@pytest.mark.parametrize("samples", [10001, pytest.param(40001, marks=pytest.mark.slow)])
def test_kill_while_writing_leaves_no_half_file(tmp_path, samples):
    """SIGKILL at several moments of a loop that only writes: the file under its final name can
    always be read."""
    late = samples / 10001  # a larger file takes longer
    moments = {tmp_path / str(delay) / "victim.nc": late * delay for delay in MOMENTS}
    command = [sys.executable, "-c", KILLED, str(samples), *map(str, moments)]
    writer = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    killed = set()
    try:
        for delay in moments.values():
            child = next(each for line in writer.stdout if (each := int(line)) not in killed)
            time.sleep(delay)
            os.kill(child, signal.SIGKILL)
            killed.add(child)
    finally:
        writer.kill()
        writer.communicate()
    assert [Trajectory.load(path).time.size for path in moments] == [samples] * len(moments)


def test_an_error_in_one_run_leaves_the_others(tmp_path, monkeypatch):
    """All others are made, kept and not run again, and the message names each run that failed with its
    reason. A refusal of the machine stops all."""
    calls = []

    def execute(run, progress=None, threads=None, **kept):
        calls.append(run.label)
        if run.label in ("phi15", "h1"):
            raise ZeroDivisionError("float division by zero")
        return flight(lambda t: np.full((t.size, 3), 0.1))

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    study = Study(scenes.load("tiny"), tmp_path, Settings(workers=2))
    runs = [study.highfi(name) for name in ("phi15", "phi60", "h1", "h2")]
    with pytest.raises(StudyError) as fault:
        study.store.fill("highfi", runs)
    said = str(fault.value)
    assert said.count("ZeroDivisionError: float division by zero") == 2
    assert "phi15: " in said and "h1: " in said and "phi60" not in said
    assert sorted(calls) == sorted(run.label for run in runs)
    assert [study.store.path(run).is_file() for run in runs] == [False, True, False, True]
    calls.clear()
    assert [each.status for each in study.store.fill("highfi", runs[1::2])] == ["exited"] * 2
    assert not calls

    def full(run, *rest, **kept):
        calls.append(run.label)
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(store_module, "execute", full)
    with pytest.raises(OSError, match="No space left"):
        study.store.fill("highfi", runs)
