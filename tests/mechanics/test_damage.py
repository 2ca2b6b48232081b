"""A file that does not agree with its digest is refused, wherever the damage is: one flipped bit,
or an edit."""

import hashlib
import io
import json
import tomllib
from dataclasses import replace

import h5py
import numpy as np
import pytest

from tests.results.test_trajectory import random_trajectory
from tests.scenes.test_calibration import CALIBRATION, as_lists
from tipoff import scenes
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import Calibration
from tipoff.scenes.rail_compliance import digest

PLACES = 150  # bits that are flipped in a file, evenly spread


def compliance() -> RailCompliance:
    """Two stations of eight faces, any numbers."""
    scene, random = scenes.load("tiny"), np.random.default_rng(4)
    return RailCompliance(
        np.array([0.0, 0.2]),
        random.random((2, 8, 2, PATTERNS, PATTERNS)),
        np.arange(8) // 2,
        random.random((8, 2)),
        2e4 * np.ones((4, 2)),
        random.random((2, 8, PATTERNS, 2)),
        digest(scene),
    )


def calibration() -> Calibration:
    """Long enough for every kind of value."""
    return replace(CALIBRATION, information=np.random.default_rng(5).random((6, 6)))


KINDS = {
    "trajectory.nc": (random_trajectory, Trajectory.load, OSError),
    "walls.npz": (compliance, RailCompliance.load, ValueError),
    "calibration.toml": (calibration, Calibration.load, ValueError),
}


def same(one, other) -> bool:
    """Whether two records hold the same, to the bit."""
    if isinstance(one, Calibration):
        return as_lists(one) == as_lists(other)
    return one.hash == other.hash


def flipped(content: bytes, place: int) -> bytes:
    """With one bit inverted, another one of the eight at every place."""
    damaged = bytearray(content)
    damaged[place] ^= 1 << place % 8
    return bytes(damaged)


def targets(path, content: bytes) -> list[int]:
    """Bytes all over a file, and inside its contents: numbers of an array, and text of an
    attribute."""
    places = np.linspace(0, len(content) - 1, PLACES).astype(int).tolist()
    if path.suffix == ".nc":
        with h5py.File(path) as file:
            begin = file["rate"].id.get_offset()
        places += [begin + 8 * k + 6 for k in range(5)]  # mantissa and exponent of the first rates
        places += [
            content.find(b'"direction_error"') + 20,
            content.find(b"exited"),
            content.find(b"rad/s"),
        ]
    # the digest itself, and the end of what stands before it
    return places + list(range(len(content) - 80, len(content)))


@pytest.mark.case("X25")
@pytest.mark.parametrize("name", KINDS)
def test_one_flipped_bit_anywhere_is_refused_or_changed_nothing(tmp_path, name):
    """Bits that change nothing exist only in a file whose digest is optional: those that mark the
    digest."""
    make, load, error = KINDS[name]
    path, saved = tmp_path / name, make()
    saved.save(path)
    content, harmless = path.read_bytes(), []
    for place in targets(path, content):
        path.write_bytes(flipped(content, place))
        try:
            found = load(path)
        except error as fault:
            assert str(path) in str(fault)
        else:
            assert isinstance(found, Calibration) and same(found, saved), place
            harmless.append(place)
    assert all(place >= len(content) - 75 for place in harmless)
    path.write_bytes(content)
    load(path)
    saved.save(path)  # made again, it is whole
    load(path)


def archived(**arrays) -> bytes:
    """Content of a file of numpy with arrays of other names."""
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def one_array() -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.zeros(3))
    return stream.getvalue()


def without_rates() -> bytes:
    return random_trajectory().to_xarray().drop_vars("rate").to_netcdf(engine="h5netcdf")


# what no file of the kind has as its content, and what each of them says
OTHERS = {
    "cut": lambda content: content[:-1],
    "cut by more": lambda content: content[:-1000],
    "longer": lambda content: content + b"\n",
    "halved": lambda content: content[: len(content) // 2],
    "a byte less": lambda content: content[:100] + content[101:],
    "another header": lambda content: b"\0" * 64 + content[64:],
    "text": lambda _: b"travel = 1\n",
    "empty": lambda _: b"",
    "a trajectory without rates": lambda _: bytes(without_rates()),
    "other arrays": lambda _: archived(travel=np.zeros(3), stiffness=np.ones(3)),
    "one array": lambda _: one_array(),
    "a number": lambda _: b"constants = 3\n",
    "no TOML": lambda _: b"objective = [",
    "other keys": lambda _: b"colour = 1\ninformation = []\n",
}
SAYS = {
    "trajectory.nc": "not a whole trajectory file",
    "walls.npz": "not a file of rail compliance",
    "calibration.toml": "not a calibration file|differs from its digest|no digest",
}


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("other", OTHERS)
def test_a_file_of_other_content_is_refused(tmp_path, name, other):
    make, load, error = KINDS[name]
    make().save(tmp_path / name)
    (tmp_path / name).write_bytes(OTHERS[other]((tmp_path / name).read_bytes()))
    with pytest.raises(error, match=SAYS[name]) as fault:
        load(tmp_path / name)
    assert str(tmp_path / name) in str(fault.value)


def test_an_outcome_edited_by_another_program_is_refused(tmp_path):
    path = tmp_path / "run.nc"
    random_trajectory().save(path)
    with h5py.File(path, "r+") as file:
        told = json.loads(file.attrs["outcome"])
        file.attrs["outcome"] = json.dumps(told | {"rate": [99.0, 0.0, 0.0]})
    with pytest.raises(
        OSError,
        match="run.nc: not a whole trajectory file: it has no digest|differs from its digest",
    ):
        Trajectory.load(path)


def test_other_programs_read_what_carries_a_digest(tmp_path):
    """HDF5, zip and TOML pass over the last line: the arrays are those that were written."""
    run, rail = random_trajectory(), compliance()
    run.save(tmp_path / "run.nc")
    rail.save(tmp_path / "walls.npz")
    calibration().save(tmp_path / "calibration.toml")
    for name in ("run.nc", "walls.npz", "calibration.toml"):
        content = (tmp_path / name).read_bytes()
        assert content[-75:] == f"# sha-256 {hashlib.sha256(content[:-75]).hexdigest()}\n".encode()
    with h5py.File(tmp_path / "run.nc") as file:
        assert np.array_equal(file["rate"], run.rate)
    with np.load(tmp_path / "walls.npz") as found:
        assert np.array_equal(found["flexibility"], rail.flexibility)
    assert (
        tomllib.loads((tmp_path / "calibration.toml").read_text(encoding="utf-8"))["objective"]
        == CALIBRATION.objective
    )


def test_a_calibration_edited_on_purpose_needs_no_digest(tmp_path):
    """With the digest it is refused, and the error names the remedy; without a digest it is
    accepted."""
    path = tmp_path / "calibration.toml"
    calibration().save(path)
    edited = path.read_text(encoding="utf-8").replace(
        '"friction.static" = 0.25', '"friction.static" = 0.3'
    )
    path.write_text(edited, encoding="utf-8")
    with pytest.raises(
        ValueError,
        match="calibration.toml differs from its digest.*remove the line '# sha-256",
    ):
        Calibration.load(path)
    for more in ("\n# a remark\n", "\r\n"):
        path.write_text(edited + more, encoding="utf-8")
        with pytest.raises(ValueError, match="digest"):
            Calibration.load(path)
    path.write_text("".join(edited.splitlines(keepends=True)[:-1]), encoding="utf-8")
    assert Calibration.load(path).constants["friction.static"] == 0.3


DOCUMENT = {
    "key": "k",
    "rows": [{"rate": 0.1 + 0.2, "name": "µ", "none": None, 3: [1, 2.5e-300]}],
    "b": {"z": 1, "a": True},
}


def test_json_carries_its_digest_and_stays_plain(tmp_path):
    from tipoff.files import DamageError, read_json, write_json

    path = tmp_path / "a.json"
    written = write_json(path, DOCUMENT)
    plain = json.loads(path.read_text())
    assert read_json(path) == plain == json.loads(json.dumps(written))
    assert {name for name in plain if name not in DOCUMENT} == {"format", "sha256"}
    content = path.read_bytes()
    for place in range(len(content)):
        path.write_bytes(flipped(content, place))
        try:
            # a blank of the layout, or a digit below the precision of a double
            assert read_json(path) == plain, place
        except DamageError as fault:
            assert str(path) in str(fault) and fault.reason
    # another layout of the same content
    path.write_text(json.dumps(plain, indent=8, sort_keys=True))
    assert read_json(path) == plain
    for other in (
        {**plain, "key": "x"},
        {name: item for name, item in plain.items() if name != "sha256"},
        [plain],
        3,
    ):
        path.write_text(json.dumps(other))
        with pytest.raises(DamageError):
            read_json(path)
    assert (
        write_json(path, written | {"key": "x"})["sha256"] != written["sha256"]
        and read_json(path)["key"] == "x"
    )
