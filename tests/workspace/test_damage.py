"""Damage to a stored result never reaches a result made of it: it is said, and what was damaged is
made again, with the same numbers."""

import json
import math

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from tests.scenes.test_calibration import CALIBRATION
from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.files import write_json
from tipoff.results.trajectory import Trajectory
from tipoff.studies.cli import app
from tipoff.studies.runs import stage as runs
from tipoff.studies.view import stage as view
from tipoff.workspace import machine
from tipoff.workspace import store as store_module
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, read
from validation.bench import reference

RATE = 0.125  # rad/s, of which means are exact


@pytest.fixture
def engine(monkeypatch):
    """A reference that needs no time: counts its calls, and tells the time a run took by their
    number."""
    calls = []

    def execute(run, progress=None, threads=None, **kept):
        calls.append(run.label)
        found = flight(lambda t: np.full((t.size, 3), RATE))
        times = {"ns_per_element_step": 1.0, "ns_per_element_stepped": 1.0}
        found.cost.update(wall_s=float(len(calls)), elements=8, **times)
        return found

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    monkeypatch.setattr("tipoff.studies.runs.stage.stresses.facts", lambda run: {})
    return calls


@pytest.fixture
def study(tmp_path):
    return Study(scenes.load("tiny"), tmp_path / "tiny", Settings(workers=1), ("phi15", "phi60"))


def flip(path, place: int) -> None:
    """Invert one bit."""
    content = bytearray(path.read_bytes())
    content[place] ^= 1 << place % 8
    path.write_bytes(content)


def rates(document: dict) -> list:
    return [row["settled"]["rate_deg_s"] for row in document["conditions"]]


def test_a_stage_is_never_made_again_from_a_damaged_trajectory(engine, study, capsys):
    """One bit in the digits of a rate, and 99 rad/s written by another program: the run is made
    again, and the stage of that."""
    first = runs.run(study, "highfi").document
    assert rates(first) == [[math.degrees(RATE)] * 3] * 2
    path = study.path(first["conditions"][0]["trajectory"])

    def edit(path):
        with h5py.File(path, "r+") as file:
            file.attrs["outcome"] = json.dumps(
                json.loads(file.attrs["outcome"]) | {"rate": [99.0, 0.0, 0.0]}
            )

    for number, damage in enumerate(
        (edit, lambda path: flip(path, path.read_bytes().find(b'"rate": [0.1') + 11))
    ):
        capsys.readouterr()
        damage(path)
        again = runs.run(study, "highfi").document
        assert rates(again) == rates(first)
        assert engine == ["phi15", "phi60"] + (number + 1) * ["phi15"]
        told = capsys.readouterr().err
        assert f"{path} is damaged or was edited: phi15 is run again" in told
        assert again["files"] != first["files"] and Trajectory.load(path).outcome.rate == [RATE] * 3
        kept = runs.run(study, "highfi").document
        assert kept == again and "is made again" not in capsys.readouterr().err


def test_a_result_tells_what_it_took(engine, study):
    """Wall time and number of runs. Control: those of stored runs are not counted."""
    made = runs.run(study, "highfi")
    assert made.took["runs"] == len(engine) == 2 and made.took["wall_s"] > 0.0
    assert made.state == machine.state() and made.state["version"]
    assert runs.run(study, "highfi").took == made.took
    study.path("highfi.json").unlink()
    assert runs.run(study, "highfi").took["runs"] == 0


def test_a_result_that_is_only_shown_is_not_shown_when_it_was_edited(study, capsys):
    """Which the report, the choice of a model and other stages read without making it."""
    path = study.path("cost_study.json")
    write_json(path, {"key": "k", "error": 0.5})
    assert study.stored("cost_study", lambda found: "k")["error"] == 0.5
    path.write_text(path.read_text().replace("0.5", "0.1"))
    assert study.stored("cost_study", lambda found: "k") is None and read(path) is None
    told = capsys.readouterr().err
    assert told.count(f"{path} is damaged or was edited: repeat the command that wrote it") == 1


def test_pictures_of_a_view_that_were_altered_are_not_shown(study):
    (study.folder / "view").mkdir(parents=True)
    picture = study.path("view/peak.png")
    picture.write_bytes(b"picture")
    point = (0.0, 0.0, 0.0)
    peak = view.Peak(stress_pa=1.0, place_m=point, rail="", time_s=0.0, frame=0)
    words = dict.fromkeys(("scene", "condition", "folder", "collection", "title"), "phi15")
    numbers = {"element_size_m": 8e-3, "factor": 1.0, "bounds_m": (point, point)}
    found = view.View(
        **words, **numbers, frames=(), peak=peak, pictures={}, without_pictures="no pyvista"
    )
    view.stage_of("phi15").run(study, view.ViewOptions("phi15", 2), lambda: (found, [picture]))
    assert view.stored(study) == [found]
    flip(picture, 3)
    assert view.stored(study) == []


def test_edited_times_of_a_benchmark_are_not_shown(tmp_path, capsys):
    path = tmp_path / "bench" / "highfi.json"
    write_json(path, {"rows": [{"ns_one_thread": 9.0}]})
    assert reference.stored(tmp_path)["rows"][0]["ns_one_thread"] == 9.0
    path.write_text(path.read_text().replace("9.0", "1.0"))
    assert (
        reference.stored(tmp_path) is None
        and f"{path} is damaged or was edited" in capsys.readouterr().err
    )


def test_an_edited_calibration_is_bad_input_until_its_digest_is_removed(tmp_path):
    path = tmp_path / "calibration.toml"
    CALIBRATION.save(path)
    edited = path.read_text(encoding="utf-8").replace(
        '"friction.static" = 0.25', '"friction.static" = 0.26'
    )
    path.write_text(edited, encoding="utf-8")
    asked = [
        "run",
        "--scene",
        "tiny",
        "--model",
        "springs",
        "--calibration",
        str(path),
        "--out",
        str(tmp_path / "out"),
    ]
    told = CliRunner().invoke(app, asked)
    assert told.exit_code == 2 and f"{path} differs from its digest" in told.stderr
    assert (
        "remove the line '# sha-256 ...' if you edited the file on purpose" in told.stderr
        and not (tmp_path / "out").exists()
    )


def test_every_netcdf_result_carries_a_digest(tmp_path):
    """Those that only users read, too: the stages keep the digests of whole files, and who copies
    one file can check it."""
    from tipoff.files import FORMAT, FORMAT_KEY, require_whole
    from tipoff.studies.measured import analysis, signals
    from tipoff.studies.measured.sheet import SAMPLES

    drop = analysis.analyse(SAMPLES[0])
    signals.write(tmp_path / "measured.nc", [drop._replace(name="a"), drop._replace(name="b")])
    require_whole(tmp_path / "measured.nc")
    with h5py.File(tmp_path / "measured.nc") as file:
        assert set(file) == {"a", "b"} and file.attrs[FORMAT_KEY] == FORMAT
    flip(tmp_path / "measured.nc", 5000)
    with pytest.raises(ValueError, match="measured.nc differs from its digest"):
        require_whole(tmp_path / "measured.nc")
