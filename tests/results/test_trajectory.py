"""Results on disk: bit for bit, whole or not at all, and never with a NaN."""

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

from tests.scenes.support import motion
from tests.written_names import ARRAYS
from tipoff.files import content_hash, replacing, write_json, write_netcdf, write_text
from tipoff.mechanics import ledger
from tipoff.mechanics.outcome import Outcome
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import load


def random_trajectory(**parts) -> Trajectory:
    rng = np.random.default_rng(3)
    n, entries = 7, len(ledger.ENTRIES)
    arrays = {
        name: rng.normal(size=(n, 4 if "quaternion" in name else 3))
        for name in ARRAYS
        if name not in ("time", "pad_force")
    }
    arrays |= {
        "energy": rng.normal(size=(n, entries)),
        "transverse_energy": rng.normal(size=(n, entries)),
        "pad_force": rng.normal(size=(n, 5, 3)),
        "time": np.sort(rng.uniform(size=n)),
    }
    arrays["position"][0] = [-0.0, 5e-324, 1.7976931348623157e150]
    result = Outcome(
        0.1 + 0.2, 1 / 3, [1.0, -2e-17, 3.0], [0.1, 0.2, 0.3], 1e-9, 2e-9, [0.0, 1e-3, -1e-3]
    )
    given = dict(
        status="exited",
        outcome=result,
        checks={"energy_error": 1.2345678901234567e-7},
        cost={"wall_s": 0.1, "steps": 10**12},
        scene=load("tiny").resolved(),
        message='µm "quoted"\nand a second line',
        numerics={"step": None, "order": 2},
    )
    return motion(**arrays | given | parts)


def test_round_trip_is_bit_for_bit(tmp_path):
    saved = random_trajectory()
    saved.save(tmp_path / "a.nc")
    found = Trajectory.load(tmp_path / "a.nc")
    for name in ARRAYS:
        assert getattr(found, name).tobytes() == getattr(saved, name).tobytes()
        assert getattr(found, name).dtype == getattr(saved, name).dtype
    for name in (
        "outcome",
        "checks",
        "cost",
        "scene",
        "status",
        "model",
        "message",
        "numerics",
        "versions",
    ):
        assert getattr(found, name) == getattr(saved, name)
    assert isinstance(found.cost["steps"], int)


def test_a_run_without_outcome_round_trips(tmp_path):
    random_trajectory(status="diverged", outcome=Outcome()).save(tmp_path / "a.nc")
    assert Trajectory.load(tmp_path / "a.nc").outcome == Outcome()


def test_a_scene_with_many_conditions_fits_the_file(tmp_path):
    """HDF5 attributes are limited to 64 KiB unless they are stored apart from the object header."""
    scene = (
        load("reference")
        .replace({f"conditions.{'c' * 60}{i}": {"duration": "50 ms"} for i in range(900)})
        .resolved()
    )
    assert len(json.dumps(scene)) > 2**16
    random_trajectory(scene=scene).save(tmp_path / "a.nc")
    assert Trajectory.load(tmp_path / "a.nc").scene == scene


def test_units_and_names_are_in_the_file():
    data = random_trajectory().to_xarray()
    assert all(data[name].attrs["units"] for name in data.data_vars)
    assert list(data["axis"].values) == ["x", "y", "z"]
    assert list(data["entry"].values) == list(ledger.ENTRIES)


@pytest.mark.parametrize(
    "parts",
    [{}, {"wall_stress": np.ones((7, 2, 6))}, {"pad_force": np.ones((7, 0, 3))}],
    ids=["springs", "stress", "no contact"],
)
def test_a_file_is_what_xarray_writes(tmp_path, parts):
    """A file that xarray wrote, such as those of earlier versions, is read too."""
    run = random_trajectory(**parts)
    run.save(tmp_path / "a.nc")
    write_netcdf(tmp_path / "b.nc", run.to_xarray())
    with (
        xarray.open_dataset(tmp_path / "a.nc") as one,
        xarray.open_dataset(tmp_path / "b.nc") as two,
    ):
        assert one.identical(two) and list(one) == list(two) and one.sizes == two.sizes
    assert Trajectory.load(tmp_path / "b.nc").to_xarray().identical(run.to_xarray())


@pytest.mark.parametrize("name", ARRAYS)
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_no_nan_in_arrays(name, bad):
    values = getattr(random_trajectory(), name).copy()
    values.flat[-1] = bad
    with pytest.raises(ValueError, match=f"^{name} holds NaN"):
        random_trajectory(**{name: values})


@pytest.mark.parametrize(
    "parts, place",
    [
        ({"checks": {"energy_error": float("nan")}}, "checks.energy_error"),
        ({"cost": {"dt_s": float("inf")}}, "cost.dt_s"),
        ({"outcome": Outcome(rate=[0.0, float("nan"), 0.0])}, "outcome.rate.1"),
        ({"numerics": {"a": {"b": np.float64("nan")}}}, "numerics.a.b"),
    ],
)
def test_no_nan_in_attributes(parts, place):
    with pytest.raises(ValueError, match=f"^{place}: NaN"):
        random_trajectory(**parts)


@pytest.mark.parametrize(
    "name, shape",
    [
        ("position", (7, 2)),
        ("quaternion", (7, 3)),
        ("rate", (6, 3)),
        ("energy", (7, 9)),
        ("time", (8,)),
        ("pad_force", (7, 3)),
    ],
)
def test_arrays_of_the_wrong_shape(name, shape):
    with pytest.raises(ValueError, match="has shape"):
        random_trajectory(**{name: np.zeros(shape)})


@pytest.mark.parametrize(
    "wrong",
    [{"exit_time": "0.02"}, {"rate": 1.0}, {"rate": [1.0, 2.0]}, {"velocity": [1.0, None, 2.0]}],
    ids=str,
)
def test_an_outcome_that_is_no_number(wrong):
    with pytest.raises(ValueError, match=f"^outcome.{next(iter(wrong))}: given"):
        random_trajectory(outcome=Outcome(**wrong))


@pytest.mark.parametrize(
    "wrong",
    [{"cost": "a"}, {"cost": {"wall_s": "1 s"}}, {"checks": {"energy_error": None}}, {"scene": []}],
    ids=str,
)
def test_tables_of_other_types_in_a_file_are_refused(wrong, tmp_path):
    whole = random_trajectory()
    (name,) = wrong
    found = whole.to_xarray()
    found.attrs[name] = json.dumps(wrong[name])
    write_netcdf(tmp_path / "a.nc", found)
    with pytest.raises(OSError, match="a.nc: not a whole trajectory file"):
        Trajectory.load(tmp_path / "a.nc")


def test_samples_out_of_order():
    whole = random_trajectory()
    with pytest.raises(ValueError, match="time falls"):
        replace(whole, time=whole.time[::-1])


def test_unknown_status():
    with pytest.raises(ValueError, match="'fine', expected one of"):
        random_trajectory(status="fine")


def test_a_missing_file(tmp_path):
    with pytest.raises(FileNotFoundError, match="none.nc: no such trajectory file"):
        Trajectory.load(tmp_path / "none.nc")


def test_an_exception_while_writing_leaves_the_old_file(tmp_path):
    write_text(tmp_path / "a.txt", "old")
    with pytest.raises(RuntimeError), replacing(tmp_path / "a.txt") as temporary:
        temporary.write_text("half")
        raise RuntimeError("interrupted")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_an_exception_while_saving_leaves_nothing(tmp_path, monkeypatch):
    def broken(_):
        raise OSError("disk full")

    monkeypatch.setattr(os, "fsync", broken)
    with pytest.raises(OSError, match="disk full"):
        random_trajectory().save(tmp_path / "a.nc")
    assert list(tmp_path.iterdir()) == []


KILLED = """
import sys, time
from tipoff.files import replacing
with replacing(sys.argv[1]) as temporary:
    with open(temporary, "w") as stream:
        stream.write("half")
        stream.flush()
        print("writing", flush=True)
        time.sleep(60)
"""
NAIVE = KILLED.replace(
    "from tipoff.files import replacing", "from contextlib import nullcontext as replacing"
)


@pytest.mark.parametrize("program, survives", [(KILLED, True), (NAIVE, False)])
def test_a_killed_process_leaves_no_half_written_file(tmp_path, program, survives):
    """Control: writing to the final name itself, which the same kill leaves half written."""
    path = tmp_path / "a.txt"
    path.write_text("old")
    root = Path(__file__).resolve().parents[2]
    process = subprocess.Popen(
        [sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE, text=True, cwd=root
    )
    assert process.stdout.readline() == "writing\n"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    assert (path.read_text() == "old") == survives


def test_json_is_strict(tmp_path):
    with pytest.raises(ValueError):
        write_json(tmp_path / "a.json", {"rate": float("nan")})
    assert list(tmp_path.iterdir()) == []


def test_content_hash_is_of_the_content():
    assert (
        content_hash({"a": 1.0, "b": [2]})
        == content_hash({"b": [2], "a": 1.0})
        != content_hash({"a": 1.0, "b": [3]})
    )
