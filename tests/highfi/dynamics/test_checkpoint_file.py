"""X20: only a whole checkpoint of the same run is resumed, and a reader never finds an incomplete
file."""

import copy
import os
import random
import threading
from dataclasses import replace

import numpy as np
import pytest

from tests.highfi.support import COARSE, SOON, begun, replace_constants, stopped, tiny
from tipoff import highfi
from tipoff.files import discard, sealed, write_sealed
from tipoff.highfi import CheckpointError, Numerics
from tipoff.highfi.dynamics import checkpoint
from tipoff.highfi.dynamics.checkpoint import Checkpoint
from tipoff.highfi.simulation import Loop

pytestmark = pytest.mark.case("X20")


@pytest.fixture(scope="module")
def loop() -> Loop:
    """A run that has just begun and goes no further."""
    return begun()


@pytest.fixture
def kept(tmp_path, loop) -> Checkpoint:
    """Its checkpoint."""
    kept = Checkpoint(tmp_path / "run.checkpoint", 0.0, loop, COARSE)
    kept.write(loop)
    return kept


@pytest.mark.case("X25")
def test_one_flipped_bit_anywhere_is_refused(kept):
    content = kept.path.read_bytes()
    last = range(len(content) - 76, len(content))
    places = [0, *random.Random(7).sample(range(len(content) - 76), 60), *last]
    for place in places:
        damaged = bytearray(content)
        damaged[place] ^= 1 << place % 8
        kept.path.write_bytes(damaged)
        with pytest.raises(CheckpointError, match="damaged"):
            kept.read()
    kept.path.write_bytes(content)
    assert kept.read() is not None


@pytest.mark.parametrize("length", [0, 1, 40, 85, 86, 4000, -1])
def test_cut_file_is_refused(kept, length):
    kept.path.write_bytes(kept.path.read_bytes()[:length])
    with pytest.raises(CheckpointError, match="has no digest of its content, or a damaged one"):
        kept.read()


def resealed(kept, change) -> None:
    """Arrays of the checkpoint after ``change``, with a digest that fits, as a file of another program
    may have it."""
    with np.load(kept.path) as archive:
        arrays = dict(archive)
    change(arrays)
    with sealed(kept.path) as temporary, open(temporary, "wb") as stream:
        np.savez(stream, **arrays)


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda arrays: arrays.pop("header"), "damaged or foreign"),
        (lambda arrays: arrays.update(header=np.array("[]")), "damaged or foreign"),
        (lambda arrays: arrays.pop("wall"), "lacks the value wall"),
        (lambda arrays: arrays.update(rests=arrays["rests"][:1]), "has rests in the shape"),
        (lambda arrays: arrays.update(steps=np.array("x")), "has steps"),
        (lambda arrays: arrays.update(rows=np.array(1.0)), "has rows"),
    ],
    ids=["no header", "other header", "missing", "cut", "text", "no list"],
)
def test_whole_files_of_other_values_are_refused(kept, loop, change, words):
    """And nothing of the run is changed by them."""
    resealed(kept, change)
    before = checkpoint.digest(checkpoint.arrays(checkpoint.evolving(loop)))
    with pytest.raises(CheckpointError, match=words) as fault:
        kept.resume(loop, kept.read())
    assert str(fault.value).startswith(str(kept.path))
    assert checkpoint.digest(checkpoint.arrays(checkpoint.evolving(loop))) == before


def test_bytes_that_are_no_archive_are_refused(kept):
    write_sealed(kept.path, b"no archive")
    with pytest.raises(CheckpointError, match="damaged or foreign"):
        kept.read()


@pytest.mark.parametrize(
    "change, words",
    [
        ({"scene": tiny(payload__mass="9 kg")}, "belongs to another scene;"),
        (
            {"numerics": Numerics(element_size=0.008, safety=0.8)},
            r"belongs to a run with other numerics \(safety 0.9, not 0.8\);",
        ),
    ],
)
def test_checkpoint_of_another_run_is_refused(kept, change, words):
    """By the run itself, and before it has stepped: no progress is reported."""
    asked = {"scene": tiny(), "numerics": COARSE} | change
    with pytest.raises(CheckpointError, match=words) as fault:
        highfi.run(
            **asked,
            progress=lambda fraction: pytest.fail("stepped"),
            checkpoint=kept.path,
            resume=True,
        )
    assert str(fault.value).startswith(str(kept.path))
    assert str(fault.value).endswith(
        "; remove it, or run without resuming, to start from the beginning"
    )


def test_checkpoint_of_another_program_or_mesh_is_refused(kept, loop, monkeypatch):
    other, stepping = copy.copy(loop), loop.setup.stepping
    other.stepper = copy.copy(loop.stepper)
    replace_constants(other, stepping=replace(stepping, dt_s=np.nextafter(stepping.dt_s, 0.0)))
    with pytest.raises(CheckpointError, match="another mesh or with another step"):
        Checkpoint(kept.path, 0.0, other, COARSE).read()
    monkeypatch.setattr(checkpoint.sources, "digest", lambda *modules, without: "another program")
    with pytest.raises(CheckpointError, match="another version of the program"):
        Checkpoint(kept.path, 0.0, loop, COARSE).read()


def test_no_file_is_a_run_from_the_beginning_and_a_folder_is_none(tmp_path, loop):
    assert Checkpoint(tmp_path / "none", 0.0, loop, COARSE).read() is None
    with pytest.raises(CheckpointError, match="cannot be read"):
        Checkpoint(tmp_path, 0.0, loop, COARSE).read()


def test_bad_arguments_are_refused(tmp_path):
    with pytest.raises(ValueError, match="resume"):
        highfi.run(tiny(), COARSE, resume=True)
    for every in (-1.0, float("nan")):
        with pytest.raises(ValueError, match="checkpoint_every"):
            highfi.run(tiny(), COARSE, checkpoint=tmp_path / "run", checkpoint_every=every)


@pytest.mark.parametrize("change", [SOON, pytest.param({}, marks=pytest.mark.slow)])
def test_nothing_is_written_before_it_is_time(tmp_path, change):
    loop = begun(tiny(**change))
    loop.integrate(None, Checkpoint(tmp_path / "run", 3600.0, loop, COARSE))
    assert len(loop.recorded.rows) > 10
    assert not list(tmp_path.iterdir())


def test_reader_never_sees_half_a_file(kept):
    """A thread reads as fast as it can what another writes as fast as it can: every look finds a
    whole file."""
    loop, ended, seen = begun(), threading.Event(), []

    def read():
        while not ended.is_set():
            seen.append(len(kept.read()["rows"]))

    reader = threading.Thread(target=read)
    reader.start()
    for _ in range(60):
        loop.advance_one_sample()
        kept.write(loop)
    ended.set()
    reader.join()
    assert seen == sorted(seen) and len(set(seen)) > 10


def test_write_that_fails_leaves_the_file_before(kept, monkeypatch):
    before, loop = kept.path.read_bytes(), stopped(3)
    monkeypatch.setattr(os, "fsync", _no_space)
    with pytest.raises(OSError, match="no space"):
        kept.write(loop)
    assert kept.path.read_bytes() == before
    assert list(kept.path.parent.iterdir()) == [kept.path]


def _no_space(descriptor):
    raise OSError("no space")


def test_discarding_takes_leftovers_of_a_kill_along(kept):
    (kept.path.parent / f".{kept.path.name}.abcd.checkpoint").write_bytes(b"half")
    (kept.path.parent / "other.checkpoint").write_bytes(b"another run")
    discard(kept.path)
    assert [path.name for path in kept.path.parent.iterdir()] == ["other.checkpoint"]
    discard(kept.path)
