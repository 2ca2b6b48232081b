"""Ensembles in a store: stopped, killed, damaged or out of disk, they end with the bits of an
undisturbed run."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import zarr

from tipoff import cache, lowfi
from tipoff.lowfi.ensemble import store as stores
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn, Listed
from tipoff.lowfi.ensemble.store import StoreError
from tipoff.scenes import load, uncertainty

ROOT = Path(__file__).resolve().parents[3]
CASES, CHUNK = 76, 16

# A process that is killed while it writes chunk 2: results are there, inputs only in part, the mark
# is not.
KILLED = """
import os, signal, sys
from tests.lowfi.ensemble.test_store import CHUNK, ensemble, fill, stores

class Deadly:
    def __init__(self, array):
        self.array = array
    def __setitem__(self, place, values):
        if place.start == 2 * CHUNK:
            os.kill(os.getpid(), signal.SIGKILL)
        self.array[place] = values

stores.CHUNK = CHUNK
asked = ensemble()
store = asked.store(sys.argv[1])
store._inputs[3] = Deadly(store._inputs[3])
fill(asked, store)
"""


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    monkeypatch.setattr(stores, "CHUNK", CHUNK)


def ensemble(scene=None, numerics=lowfi.Numerics(relative_tolerance=1e-2), **changed) -> Ensemble:
    scene = scene or load("clamped")
    return Ensemble(
        scene,
        Drawn(uncertainty.load("paper", scene, **{"cases": CASES, **changed})),
        None,
        numerics,
    )


@pytest.fixture(scope="module")
def digest(tmp_path_factory) -> str:
    """Of the undisturbed run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stores, "CHUNK", CHUNK)
        asked = ensemble()
        store = asked.store(tmp_path_factory.mktemp("whole") / "store")
        assert fill(asked, store) == CASES
        return store.digest()


def test_a_killed_process_is_resumed_to_the_same_bits(tmp_path, digest):
    path = tmp_path / "store"
    killed = subprocess.run(
        [sys.executable, "-c", KILLED, str(path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert killed.returncode == -9, killed.stderr
    store = ensemble().store(path)
    # written, yet not taken for done
    assert np.isfinite(store.column("rate")[2 * CHUNK : 3 * CHUNK]).all()
    assert store.pending() == [2, 3, 4]
    told = []
    assert fill(ensemble(), store, workers=1, progress=told.append) == CASES - 2 * CHUNK
    assert told == [48, 64, 76]
    assert store.digest() == digest and fill(ensemble(), store) == 0


def test_progress_is_that_of_the_cases_done(tmp_path, monkeypatch):
    """A chunk of 4,096 slow cases took minutes, without a word. Its pieces are told."""
    monkeypatch.setattr("tipoff.lowfi.ensemble.fill.PIECE", 5)
    told, asked = [], ensemble()
    fill(asked, asked.store(tmp_path / "store"), workers=1, progress=told.append)
    assert told == sorted(set(told)) and told[-1] == CASES
    assert told[:4] == [5, 10, 15, CHUNK] and {CHUNK, 2 * CHUNK} <= set(told)


def test_a_full_disk_is_reported_and_the_store_resumes(tmp_path, digest, monkeypatch):
    asked, real, left = ensemble(), cache.write_json, [2]

    def full(path, value):
        left[0] -= path.parent.name == "done"
        if left[0] < 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(path, value)

    monkeypatch.setattr(cache, "write_json", full)
    with pytest.raises(
        StoreError,
        match=r"No space left on device; 32 of 76 cases are stored, and the same command goes on",
    ):
        fill(asked, asked.store(tmp_path / "store"))
    monkeypatch.setattr(cache, "write_json", real)
    store = asked.store(tmp_path / "store")
    assert fill(asked, store) == CASES - 2 * CHUNK
    assert store.digest() == digest


def test_a_column_stays_until_another_is_in_its_place(tmp_path, monkeypatch):
    """A disk that fails in between leaves the old one. Control: without a failure the new one is there."""
    store = ensemble().store(tmp_path / "store")
    store.add("told", {}, (np.full(end - begin, 1.0) for begin, end in places(store)))
    assert stored(store, "told") == [1.0] * CASES
    real = os.replace

    def failing(source, target):
        if Path(source).parent.name == "group" and Path(target).parent.name == "cases.zarr":
            raise OSError(errno.EIO, "Input/output error")
        real(source, target)

    monkeypatch.setattr(os, "replace", failing)
    with pytest.raises(StoreError, match="Input/output error"):
        store.add("told", {}, (np.full(end - begin, 2.0) for begin, end in places(store)))
    monkeypatch.setattr(os, "replace", real)
    assert stored(store, "told") == [1.0] * CASES
    store.add("told", {}, (np.full(end - begin, 2.0) for begin, end in places(store)))
    assert stored(store, "told") == [2.0] * CASES
    assert not [path for path in store.path.iterdir() if path.name.startswith(".told")]


def places(store):
    """First case of each chunk, and first of the next."""
    return [store.bounds(number) for number in range(len(store))]


def stored(store, name: str) -> list[float]:
    """The values of a column in the folder."""
    return zarr.open_group(store.path / "cases.zarr", mode="r")[name][:].tolist()


@pytest.mark.parametrize(
    "other, name",
    [
        (lambda: ensemble(load("clamped").replace({"payload.mass": "10 kg"})), "scene"),
        (lambda: ensemble(seed=2), "cases"),
        (lambda: ensemble(numerics=lowfi.Numerics()), "numerics"),
        (lambda: ensemble()._replace(widening=1e-6), "widening"),
    ],
)
def test_a_store_of_another_ensemble_is_refused(tmp_path, other, name):
    ensemble().store(tmp_path / "store")
    with pytest.raises(StoreError, match=f"holds another ensemble: {name} differ"):
        other().store(tmp_path / "store")


def test_a_store_of_other_code_or_no_store_is_refused(tmp_path, monkeypatch):
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / "letter.txt").write_text("mine")
    with pytest.raises(StoreError, match="no store of an ensemble"):
        ensemble().store(tmp_path / "foreign")
    assert (tmp_path / "foreign" / "letter.txt").read_text() == "mine"
    ensemble().store(tmp_path / "store")
    monkeypatch.setattr(
        "tipoff.lowfi.ensemble.request.code", lambda: {"code": "other", "versions": {}}
    )
    with pytest.raises(StoreError, match="code, versions differ"):
        ensemble().store(tmp_path / "store")


def test_one_case_alone_has_the_stored_bits(tmp_path):
    asked = ensemble(sampling="sobol")
    store = asked.store(tmp_path / "store")
    fill(asked, store, workers=2)
    for number in (0, 33, CASES - 1):
        row, case = asked.case(number)
        results, inputs = store.read(number, number + 1)
        assert inputs[0].tolist() == list(row.values())
        assert results.rate[0].tolist() == case.outcome.rate and results.steps[0] == case.steps
        assert (
            case.outcome.rate
            == lowfi.run(asked.scene.replace(row), "springs", numerics=asked.numerics).outcome.rate
        )


def test_run_many_with_a_store_is_run_many(tmp_path):
    """Bad rows are refused alone, listed with inputs and reason, and the count closes; the second
    call runs nothing."""
    key = "thrust_offset.misalignment.radial"
    rows = [
        {key: "5 deg"},
        {key: 0.7},
        {"payload.mass": -1.0},
        {"contact.clearence": 1e-4},
        {"payload.mass": float("nan")},
        {"thrust.peak": 1e200, "thrust_offset.misalignment.axial": 0.0},
        {key: "65 deg"},
    ]
    places = ({}, *2 * [{"store": tmp_path / "store"}])
    plain, kept, again = (
        lowfi.run_many(load("clamped"), rows, "springs", **where) for where in places
    )
    for found in (kept, again):
        assert found.equals(plain.drop_vars("wall_s")) and found.attrs == plain.attrs == {
            "modes": 0,
            "asked": 7,
            "ok": 3,
            "refused": 3,
            "failed": 1,
        }
    assert len(list((tmp_path / "store" / "done").iterdir())) == 1
    failures = (
        Ensemble(load("clamped"), Listed(rows), None, lowfi.Numerics(modes=0))
        .store(tmp_path / "store")
        .failures()
    )
    assert [(item["case"], item["status"], item["inputs"]) for item in failures] == [
        (2, "refused", {"payload.mass": -1.0}),
        (3, "refused", {"contact.clearence": 1e-4}),
        (4, "refused", {"payload.mass": "nan"}),
        (5, "diverged", rows[5]),
    ]
    assert "clearence" in failures[1]["reason"]


def test_draws_and_nothing_at_all_can_be_stored(tmp_path):
    scene = load("clamped")
    drawn = uncertainty.load("paper", scene, cases=20)
    plain, kept = (
        lowfi.run_many(scene, drawn, "springs"),
        lowfi.run_many(scene, drawn, "springs", store=tmp_path / "store"),
    )
    assert kept.equals(plain.drop_vars("wall_s")) and plain.attrs["ok"] == 20
    assert lowfi.run_many(scene, [], "springs", store=tmp_path / "empty").attrs["asked"] == 0


def test_the_store_is_open_to_others(tmp_path):
    import xarray

    asked = ensemble(cases=20)
    store = asked.store(tmp_path / "store")
    fill(asked, store)
    found = xarray.open_zarr(tmp_path / "store" / "cases.zarr", consolidated=False, chunks=None)
    assert (
        found.rate.attrs["units"] == "rad/s"
        and found.status.attrs["flag_meanings"].split()[0] == "exited"
    )
    assert np.array_equal(found.rate.values, store.column("rate"))
    inputs = xarray.open_zarr(
        tmp_path / "store" / "cases.zarr", group="inputs", consolidated=False, chunks=None
    )
    assert inputs["thrust_offset.misalignment.axial"].attrs["units"] == "rad"
    identity = found.attrs["identity"]
    assert (
        identity["cases"]["seed"] == 1
        and identity["cases"]["vary"]["mass_offset.eccentricity.axial"]["rule"] == "redraw"
    )
    assert json.loads((tmp_path / "store" / "done" / "000001.json").read_text())["ok"] == 4


def test_a_store_that_another_process_makes_first_is_opened(tmp_path, monkeypatch):
    """Two ensembles started at once: the second finds the folder taken when it renames its own."""
    first, replace = ensemble(), os.replace

    def late(source, target):
        monkeypatch.setattr(os, "replace", replace)
        ensemble().store(tmp_path / "store")
        replace(source, target)

    monkeypatch.setattr(os, "replace", late)
    store = first.store(tmp_path / "store")
    assert [path.name for path in tmp_path.iterdir()] == ["store"]
    fill(first, store)
    assert store.pending() == []
