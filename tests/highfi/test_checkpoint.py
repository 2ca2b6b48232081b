"""X20: a run that is stopped or killed goes on from its checkpoint and ends with the same bits; no other file is taken for one."""

import functools
import os
import random
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import highfi
from highfi import CheckpointError, Numerics, checkpoint
from highfi.checkpoint import CONSTANT, FORMAT, Checkpoint, arrays, digest, restore
from highfi.records import Active, Body, State
from highfi.run import Loop
from highfi.stepping import choose
from highfi.system import build
from scenes.files import discard
from scenes.trajectory import Trajectory
from tests.highfi.support import COARSE, tiny

pytestmark = pytest.mark.case("X20")
ROOT = Path(__file__).resolve().parent.parent.parent
ARRAYS = ("time", "position", "velocity", "quaternion", "rate", "platform_position", "platform_velocity", "platform_quaternion",
          "platform_rate", "pad_force", "energy", "transverse_energy")
TOUCHING = 146  # a sample at which pads of ``tiny`` touch


@functools.cache
def whole() -> Trajectory:
    """The run that nothing interrupts."""
    return highfi.run(tiny(), COARSE)


def assert_same(found: Trajectory, expected: Trajectory) -> None:
    """All that a result holds but what it cost, bit for bit."""
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
    for name in ("status", "message", "outcome", "checks"):
        assert getattr(found, name) == getattr(expected, name), name
    assert found.cost["steps"] == expected.cost["steps"]


class Stopped(Exception):
    """The end of the part of a run that a test lets happen."""


class StopAt:
    """In the place of a run's checkpoint: ends the run after ``samples`` samples."""

    def __init__(self, samples: int):
        self.samples = samples

    def keep(self, loop: Loop) -> None:
        if len(loop.rows) > self.samples:
            raise Stopped


def begun(scene=None, numerics: Numerics = COARSE, threads: int = 1) -> Loop:
    """A loop at its first sample."""
    scene = scene or tiny()
    system = build(scene, numerics, highfi.prepare(scene, numerics))
    loop = Loop(scene, system, choose(system, scene, numerics), threads)
    loop.begin()
    return loop


def stopped(samples: int) -> Loop:
    """A loop that has marched for ``samples`` samples after the first one."""
    loop = begun()
    with pytest.raises(Stopped):
        loop.march(None, StopAt(samples))
    return loop


@pytest.fixture
def kept(tmp_path) -> Checkpoint:
    """The checkpoint of a run that has just begun."""
    loop = begun()
    kept = Checkpoint(tmp_path / "run.checkpoint", 0.0, loop, COARSE)
    kept.write(loop)
    return kept


def test_run_stopped_at_37_percent_goes_on_to_the_same_bits(tmp_path):
    """The first fraction the second part reports shows that it did not start anew, which would give the same bits too."""
    seen = []

    def stop(fraction):
        if fraction >= 0.37:
            raise Stopped

    with pytest.raises(Stopped):
        highfi.run(tiny(), COARSE, progress=stop, checkpoint=tmp_path / "run", checkpoint_every=0.0)
    resumed = highfi.run(tiny(), COARSE, progress=seen.append, checkpoint=tmp_path / "run", resume=True)
    assert seen[0] >= 0.37
    assert np.abs(resumed.pad_force).max() > 1.0
    assert_same(resumed, whole())


@pytest.mark.parametrize("samples", [1, TOUCHING, 285])
def test_any_sample_is_a_place_to_stop(tmp_path, samples):
    """At the start, while pads touch, and after the run has seen where it ends; resumed by another number of threads."""
    first, second = stopped(samples), begun(threads=2)
    kept = Checkpoint(tmp_path / "run", 0.0, first, COARSE)
    kept.write(first)
    restore(second, kept.read())
    assert len(second.rows) == samples + 1 and second.wall == first.wall
    second.march(None)
    assert_same(second.trajectory({"steps": second.steps}, COARSE), whole())


def test_every_evolving_array_is_in_the_file(tmp_path):
    """The names are those of the records, so a field that is added and not saved fails here."""
    loop = stopped(TOUCHING)
    kept = Checkpoint(tmp_path / "run", 0.0, loop, COARSE)
    kept.write(loop)
    saved = kept.read()
    bodies = [name for name in State._fields if isinstance(getattr(loop.state, name), Body)]
    expected = {f"state.{body}.{name}": getattr(getattr(loop.state, body), name) for body in bodies for name in Body._fields}
    expected |= {f"state.{name}": getattr(loop.state, name) for name in State._fields if name not in bodies}
    expected |= {f"active.{name}": getattr(loop.active, name) for name in Active._fields}
    assert len(bodies) == 2
    assert {name.partition(".")[0] for name in saved} == set(vars(loop)) - set(CONSTANT)
    for name, array in expected.items():
        assert saved[name].dtype == array.dtype
        np.testing.assert_array_equal(saved[name], array, err_msg=name)
    assert loop.active.count[0] > 0


def test_what_is_left_out_does_not_change():
    loop = begun()
    system = {"system": loop.system._replace(mesh=None, operator=None)}  # not records, and no kernel is given them
    before, others = digest(arrays(system)), (loop.marks, loop.stepping, loop.last)
    loop.march(None)
    assert digest(arrays(system)) == before
    assert (loop.marks, loop.stepping, loop.last) == others
    # A scene is frozen; a team and a pool of threads are not of the run.
    assert set(CONSTANT) == {"scene", "system", "stepping", "team", "pool", "marks", "last"}


CHILD = """
import sys
import highfi
from tests.highfi.support import COARSE, tiny
found = highfi.run(tiny(), COARSE, progress=lambda fraction: print(fraction, flush=True), checkpoint=sys.argv[1],
                   checkpoint_every=0.0, resume=True)
found.save(sys.argv[2])
"""


def test_killed_again_and_again_it_ends_with_the_same_bits(tmp_path):
    """SIGKILL at seeded moments, first of the set-up, then of the march; each life begins where the file of the last one ends."""
    whole()  # compiles what the children load
    moments, path, result = random.Random(20), tmp_path / "run", tmp_path / "result.nc"
    reader = Checkpoint(path, 0.0, begun(), COARSE)
    child = _child(path, result)
    time.sleep(moments.uniform(0.0, 1.0))
    _kill(child)
    for _ in range(3):
        rows = _rows(reader)
        child = _child(path, result)
        assert float(child.stdout.readline()) >= (rows - 1) / 300
        time.sleep(moments.uniform(0.0, 0.4))
        _kill(child)
        assert _rows(reader) >= max(rows, 19)
    rows = _rows(reader)
    child = _child(path, result)
    fractions = [float(line) for line in child.communicate(timeout=60)[0].split()]
    assert child.returncode == 0
    assert fractions[0] >= (rows - 1) / 300 and rows >= 3 * 19
    assert_same(Trajectory.load(result), whole())


def _child(path: Path, result: Path) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-c", CHILD, str(path), str(result)], cwd=ROOT, stdout=subprocess.PIPE, text=True)


def _kill(child: subprocess.Popen) -> None:
    os.kill(child.pid, signal.SIGKILL)
    assert child.wait() == -signal.SIGKILL
    child.stdout.close()


def _rows(reader: Checkpoint) -> int:
    """Samples in the file; none where there is no file."""
    saved = reader.read()
    return 0 if saved is None else len(saved["rows"])


def test_one_flipped_bit_anywhere_is_refused(kept):
    content = kept.path.read_bytes()
    places = [*range(90), *random.Random(7).sample(range(90, len(content)), 60), len(content) - 1]
    for place in places:
        damaged = bytearray(content)
        damaged[place] ^= 1 << place % 8
        kept.path.write_bytes(damaged)
        with pytest.raises(CheckpointError, match="damaged|no checkpoint|has format"):
            kept.read()
    kept.path.write_bytes(content)
    assert kept.read() is not None


@pytest.mark.parametrize("length", [0, 1, 40, 85, 86, 4000, -1])
def test_cut_file_is_refused(kept, length):
    kept.path.write_bytes(kept.path.read_bytes()[:length])
    with pytest.raises(CheckpointError, match="cut short|no checkpoint"):
        kept.read()


@pytest.mark.parametrize("change, words", [
    ({"scene": tiny(payload__mass="9 kg")}, "belongs to another scene;"),
    ({"numerics": Numerics(element_size=0.008, safety=0.8)}, r"belongs to a run with other numerics \(safety 0.9, not 0.8\);"),
])
def test_checkpoint_of_another_run_is_refused(kept, change, words):
    """By the run itself, and before it has stepped: no progress is reported."""
    asked = {"scene": tiny(), "numerics": COARSE} | change
    with pytest.raises(CheckpointError, match=words) as fault:
        highfi.run(**asked, progress=lambda fraction: pytest.fail("stepped"), checkpoint=kept.path, resume=True)
    assert str(fault.value).startswith(str(kept.path))
    assert str(fault.value).endswith("; remove it, or run without resuming, to start from the beginning")


def test_checkpoint_of_another_program_mesh_or_format_is_refused(kept, monkeypatch):
    loop = begun()
    loop.stepping = replace(loop.stepping, dt_s=np.nextafter(loop.stepping.dt_s, 0.0))
    with pytest.raises(CheckpointError, match="another mesh or with another step"):
        Checkpoint(kept.path, 0.0, loop, COARSE).read()
    monkeypatch.setattr(checkpoint, "source_hash", lambda *packages: "another program")
    with pytest.raises(CheckpointError, match="another version of the program"):
        Checkpoint(kept.path, 0.0, begun(), COARSE).read()
    line = f"tipoff checkpoint {FORMAT} ".encode()
    kept.path.write_bytes(kept.path.read_bytes().replace(line, b"tipoff checkpoint 99 ", 1))
    with pytest.raises(CheckpointError, match=f"has format 99, this program reads {FORMAT};"):
        kept.read()


def test_no_file_is_a_run_from_the_beginning_and_a_folder_is_none(tmp_path):
    loop = begun()
    assert Checkpoint(tmp_path / "none", 0.0, loop, COARSE).read() is None
    with pytest.raises(CheckpointError, match="cannot be read"):
        Checkpoint(tmp_path, 0.0, loop, COARSE).read()


def test_bad_arguments_are_refused(tmp_path):
    with pytest.raises(ValueError, match="resume"):
        highfi.run(tiny(), COARSE, resume=True)
    for every in (-1.0, float("nan")):
        with pytest.raises(ValueError, match="checkpoint_every"):
            highfi.run(tiny(), COARSE, checkpoint=tmp_path / "run", checkpoint_every=every)


def test_nothing_is_written_before_it_is_time(tmp_path):
    loop = begun()
    loop.march(None, Checkpoint(tmp_path / "run", 3600.0, loop, COARSE))
    assert not list(tmp_path.iterdir())


def test_reader_never_sees_half_a_file(kept):
    """A thread reads as fast as it can what another writes as fast as it can: every look finds a whole file."""
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
