"""Result files state the number of their format; one of another format is refused by this number."""

import json

import h5py
import pytest

from tests.mechanics.test_damage import KINDS
from tipoff.files import FORMAT, DamageError, read_json, with_digest, write_json, write_sealed
from tipoff.mechanics.rail_compliance import stored
from tipoff.results import contents
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import calibration

WRITERS = {"trajectory.nc": contents, "walls.npz": stored, "calibration.toml": calibration}


@pytest.mark.parametrize("name", KINDS)
def test_a_file_of_another_format_is_refused(name, tmp_path, monkeypatch):
    make, load, refusal = KINDS[name]
    path = tmp_path / name
    make().save(path)
    load(path)
    monkeypatch.setattr(WRITERS[name], "FORMAT", FORMAT + 1)
    make().save(path)
    with pytest.raises(
        refusal, match=f"format {FORMAT + 1}, and this version reads format {FORMAT}"
    ):
        load(path)


def test_json_states_its_format(tmp_path):
    path = tmp_path / "result.json"
    assert write_json(path, {"a": 1})["format"] == read_json(path)["format"] == FORMAT
    write_json(path, {"a": 1, "format": FORMAT + 1})
    with pytest.raises(DamageError, match=f"format {FORMAT + 1}"):
        read_json(path)


def test_files_from_before_there_was_a_number_are_read(tmp_path):
    path = tmp_path / "run.nc"
    make, _, _ = KINDS["trajectory.nc"]
    make().save(path)
    with h5py.File(path, "r+") as data:
        del data.attrs["format"]
    write_sealed(path, path.read_bytes())
    assert Trajectory.load(path).status == make().status
    path = tmp_path / "result.json"
    path.write_text(json.dumps(with_digest({"a": 1})))
    assert read_json(path)["a"] == 1
