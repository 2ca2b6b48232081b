"""Damage to a stored result never reaches a result made of it: it is said, and what was damaged is
made again, with the same numbers."""

import json
import math

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from tests.scenes.test_calibration import CALIBRATION
from tests.studies.synthetic import flight, kept_in_memory
from tipoff import scenes
from tipoff.calibration import rail_compliance as calibrated
from tipoff.files import write_json
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance, digest
from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.cli import app
from tipoff.studies.limits import results
from tipoff.studies.populations import answers
from tipoff.studies.runs import stage as runs
from tipoff.studies.view import stage as view
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
        found.cost.update(wall_s=float(len(calls)), elements=8, ns_per_element_step=1.0)
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
    first = runs.run(study, "highfi")
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
        again = runs.run(study, "highfi")
        assert rates(again) == rates(first)
        assert engine == ["phi15", "phi60"] + (number + 1) * ["phi15"]
        told = capsys.readouterr().err
        assert f"{path} is damaged or was edited" in told and "phi15 is run again" in told
        assert again["files"] != first["files"] and Trajectory.load(path).outcome.rate == [RATE] * 3
        assert runs.run(study, "highfi") == again and "is made again" not in capsys.readouterr().err


@pytest.mark.case("X25")
def test_a_flipped_bit_anywhere_in_a_stored_run_has_it_made_again(engine, study, capsys):
    run = study.highfi("phi15")
    first, path = study.store.get(run), study.store.path(run)
    for number, share in enumerate(np.linspace(0.0, 1.0, 12)):
        flip(path, round(share * (path.stat().st_size - 1)))
        again = study.store.get(run)
        assert engine == ["phi15"] * (number + 2), share
        assert again.outcome == first.outcome and np.array_equal(again.rate, first.rate)
        assert f"{path} is damaged" in capsys.readouterr().err


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(f"{math.degrees(RATE)}", "99.0", 1),
        lambda text: text.replace('"exited"', '"jammed"', 1),
        lambda text: text.replace('"failed": []', '"failed": [ "phi15: diverged" ]'),
        lambda text: text[:-20],
        lambda text: "[]",
        lambda text: text.replace('"sha256"', '"sha255"'),
    ],
)
def test_an_edited_result_file_is_made_again(engine, study, capsys, monkeypatch, change):
    kept_in_memory(monkeypatch)
    first, path = runs.run(study, "highfi"), study.path("highfi.json")
    text = path.read_text()
    assert change(text) != text
    path.write_text(change(text))
    capsys.readouterr()
    assert runs.run(study, "highfi") == first and json.loads(path.read_text()) == first
    assert f"{path} " in (told := capsys.readouterr().err) and "highfi is made again" in told
    assert len(engine) == 2  # from the stored runs, which are whole


def test_a_result_that_is_only_shown_is_not_shown_when_it_was_edited(study, capsys):
    """Which the report, the choice of a model and other stages read without making it."""
    path = study.path("cost_study.json")
    write_json(path, {"key": "k", "error": 0.5})
    assert study.stored("cost_study", lambda found: "k")["error"] == 0.5
    path.write_text(path.read_text().replace("0.5", "0.1"))
    assert study.stored("cost_study", lambda found: "k") is None and read(path) is None
    assert f"{path} differs from its digest" in capsys.readouterr().err


def test_pictures_of_a_view_that_were_altered_are_not_shown(study, monkeypatch):
    monkeypatch.setattr(view, "key_of", lambda *_: "k")
    (study.folder / "view").mkdir(parents=True)
    picture = study.path("view/peak.png")
    picture.write_bytes(b"picture")

    def make():
        return {"condition": "phi15", "asked_frames": 2, "asked_factor": None}, [picture]

    study.stage("view/phi15", "k", make)
    assert len(view.stored(study)) == 1
    flip(picture, 3)
    assert view.stored(study) == []


def test_damaged_walls_are_found_again(study, monkeypatch, capsys):
    """Stiffer or softer by one bit, they would change every rate of the surrogate on them."""
    scene, calls, random = study.scene, [], np.random.default_rng(1)
    faces = sum(len(pad.normals) for pad in scene.pads)
    known = RailCompliance(
        np.array([0.0, 0.1]),
        random.random((2, faces, PATTERNS, faces, PATTERNS)),
        np.zeros(faces, int),
        random.random((faces, 2)),
        np.ones((1, 1)),
        random.random((2, faces, PATTERNS, 1)),
        digest(scene),
    )

    def found(scene, size):
        calls.append(size)
        return known

    monkeypatch.setattr(calibrated, "compliance", found)
    assert (
        study.rail_compliance(scene).hash == study.rail_compliance(scene).hash == known.hash
        and len(calls) == 1
    )
    (path,) = study.folder.glob("compliance-*.npz")
    for number, place in enumerate(np.linspace(0, path.stat().st_size - 1, 40).astype(int)):
        flip(path, int(min(place, path.stat().st_size - 1)))
        assert study.rail_compliance(scene).hash == known.hash and len(calls) == number + 2
        assert (
            f"{path}: not a file of rail compliance" in (told := capsys.readouterr().err)
            and "found again" in told
        )


def test_damaged_cases_of_a_search_are_run_again(tmp_path, capsys):
    """The values of every set of tolerances that was tried: None asks for them anew."""
    path, values = (
        tmp_path / "limits" / "a.nc",
        np.random.default_rng(2).random((50, len(answers.ALL))),
    )
    results.save(path, values, 0.5, {"misalignment": 0.1})
    content = path.read_bytes()
    assert np.array_equal(results.load(path), values)
    for place in [
        content.find(values[7].tobytes()) + 6,
        *np.linspace(0, len(content) - 1, 60).astype(int),
    ]:
        path.write_bytes(content)
        flip(path, int(place))
        assert results.load(path) is None, place
        assert f"{path} " in (told := capsys.readouterr().err) and "run again" in told


def test_edited_times_of_a_benchmark_are_not_shown(tmp_path, capsys):
    path = tmp_path / "bench" / "highfi.json"
    write_json(path, {"rows": [{"ns_one_thread": 9.0}]})
    assert reference.stored(tmp_path)["rows"][0]["ns_one_thread"] == 9.0
    path.write_text(path.read_text().replace("9.0", "1.0"))
    assert (
        reference.stored(tmp_path) is None
        and f"{path} differs from its digest" in capsys.readouterr().err
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
    from tipoff.files import require_whole
    from tipoff.studies.droptest import analysis, signals
    from tipoff.studies.droptest.sheet import SAMPLES

    drop = analysis.analyse(SAMPLES[0])
    signals.write(tmp_path / "droptest.nc", [drop._replace(name="a"), drop._replace(name="b")])
    require_whole(tmp_path / "droptest.nc")
    with h5py.File(tmp_path / "droptest.nc") as file:
        assert set(file) == {"a", "b"}
    flip(tmp_path / "droptest.nc", 5000)
    with pytest.raises(ValueError, match="droptest.nc differs from its digest"):
        require_whole(tmp_path / "droptest.nc")
