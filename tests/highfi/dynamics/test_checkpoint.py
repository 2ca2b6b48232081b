"""X20: a run that is stopped or killed goes on from its checkpoint and ends with the same bits."""

import functools
import operator
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.highfi.support import COARSE, SOON, Stopped, begun, go_on, stopped, tiny, whole
from tests.written_names import ARRAYS_OF_REFERENCE
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics.checkpoint import Checkpoint, arrays, digest, restore
from tipoff.results.trajectory import Trajectory

pytestmark = pytest.mark.case("X20")
ROOT = Path(__file__).resolve().parents[3]
STOPS = [
    1,
    115,
    212,
]  # samples: at the start, while pads touch, and after the run has seen where it ends


def assert_same(found: Trajectory, expected: Trajectory) -> None:
    """All that a result holds but what it cost, bit for bit."""
    for name in ARRAYS_OF_REFERENCE:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
    for name in ("status", "message", "outcome", "checks", "stress"):
        assert getattr(found, name) == getattr(expected, name), name
    assert found.cost["steps"] == expected.cost["steps"]


def test_run_stopped_at_37_percent_goes_on_to_the_same_bits(tmp_path):
    """The first fraction that the second part reports shows that it did not start at the beginning,
    which would give the same bits too."""
    seen = []

    def stop(fraction):
        if fraction >= 0.37:
            raise Stopped

    with pytest.raises(Stopped):
        highfi.run(tiny(), COARSE, progress=stop, checkpoint=tmp_path / "run", checkpoint_every=0.0)
    resumed = highfi.run(
        tiny(), COARSE, progress=seen.append, checkpoint=tmp_path / "run", resume=True
    )
    assert seen[0] >= 0.37
    assert np.abs(resumed.pad_force).max() > 1.0
    assert_same(resumed, whole())


def left_out(loop) -> tuple:
    """What a checkpoint leaves out, arrays by their digest."""
    # not records, and no kernel is given them
    system = loop.setup.system._replace(mesh=None, operator=None)
    constant = digest(arrays({"system": system, "exit": loop.setup.exit}))
    return constant, loop.setup.milestones, loop.setup.stepping, loop.setup.most


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """One run to its end: what is read from its checkpoints, and its wall clock (s) there, by
    samples; what they leave out, before and after."""
    loop, saved, wall = begun(), {}, {}
    before = left_out(loop)
    kept = Checkpoint(tmp_path_factory.mktemp("made") / "run", 0.0, loop, COARSE)
    for samples in STOPS:
        go_on(loop, samples)
        kept.write(loop)
        saved[samples], wall[samples] = kept.read(), loop.recorded.wall
    loop.integrate(None)
    return SimpleNamespace(saved=saved, wall=wall, before=before, after=left_out(loop))


@pytest.mark.parametrize("samples", [pytest.param(1, marks=pytest.mark.slow), *STOPS[1:]])
def test_any_sample_is_a_place_to_stop(made, samples):
    """Resumed by another number of threads."""
    second = begun(threads=2)
    restore(second, made.saved[samples])
    assert len(second.recorded.rows) == samples + 1 and second.recorded.wall == made.wall[samples]
    second.integrate(None)
    assert_same(second.trajectory({"steps": second.stepper.steps}, COARSE), whole())


@pytest.mark.parametrize(
    "numerics, columns, change, samples",
    [
        (COARSE, False, SOON, 9),
        pytest.param(
            Numerics(element_size=0.004),
            True,
            {"duration": "9 ms", "contact__clearance": "0.05 mm"},
            45,
            marks=pytest.mark.slow,
        ),
    ],
    ids=["elements", "fine"],
)
def test_other_meshes_go_on_to_the_same_bits(tmp_path, numerics, columns, change, samples):
    """The arrays of the finer mesh also hold nodes between the rails that belong to no element."""
    scene = tiny(**change)
    first, second = (begun(scene, numerics, columns=columns) for _ in range(2))
    go_on(first, samples)
    kept = Checkpoint(tmp_path / "run", 0.0, first, numerics)
    kept.write(first)
    restore(second, kept.read())
    results = []
    for loop in (first, second):
        loop.integrate(None)
        results.append(loop.trajectory({"steps": loop.stepper.steps}, numerics))
    assert (first.setup.system.rail.columns is None) != columns
    assert np.abs(results[0].pad_force).max() > 1.0
    assert_same(*results)


def of_record(name: str, value) -> dict[str, np.ndarray]:
    """The arrays in a record, by dotted name."""
    if not hasattr(value, "_fields"):
        return {name: value}
    found = (of_record(f"{name}.{field}", getattr(value, field)) for field in value._fields)
    return functools.reduce(operator.or_, found)


def test_every_evolving_array_is_in_the_file(tmp_path):
    """The names are those of the records, so a field that is added and not saved fails here."""
    loop = stopped(9, tiny(**SOON))
    kept = Checkpoint(tmp_path / "run", 0.0, loop, COARSE)
    kept.write(loop)
    saved = kept.read()
    expected = of_record("state", loop.stepper.state) | of_record("active", loop.stepper.active)
    assert {"state.payload.spin", "state.pushing.inertia.values"} <= set(expected)
    evolving = set(vars(loop.stepper)) - {"setup"} | set(vars(loop.recorded))
    assert {name.partition(".")[0] for name in saved} == evolving
    for name, array in expected.items():
        assert saved[name].dtype == array.dtype
        np.testing.assert_array_equal(saved[name], array, err_msg=name)
    assert loop.stepper.active.node_count.max() > 0


def test_what_is_left_out_does_not_change(made):
    assert made.after == made.before


CHILD = """
import sys
from tests.written_names import ARRAYS_OF_REFERENCE
from tipoff import highfi
from tests.highfi.support import COARSE, tiny
found = highfi.run(tiny(), COARSE, progress=lambda fraction: print(fraction, flush=True), checkpoint=sys.argv[1],
                   checkpoint_every=0.0, resume=True)
found.save(sys.argv[2])
"""


@pytest.mark.slow
def test_killed_again_and_again_it_ends_with_the_same_bits(tmp_path):
    """SIGKILL at seeded moments, first in the set-up, then in the integration. Each process begins
    where the file of the one before ends."""
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
    return subprocess.Popen(
        [sys.executable, "-c", CHILD, str(path), str(result)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )


def _kill(child: subprocess.Popen) -> None:
    os.kill(child.pid, signal.SIGKILL)
    assert child.wait() == -signal.SIGKILL
    child.stdout.close()


def _rows(reader: Checkpoint) -> int:
    """Samples in the file; none where there is no file."""
    saved = reader.read()
    return 0 if saved is None else len(saved["rows"])
