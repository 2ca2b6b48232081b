"""How long a person waits: calls from Python, statics of rails by their length, files, the shell.

Each row is a call. It is made once without timing, which compiles its kernels and warms its caches, and
then ``repeats`` times by turns with the calls of its group. The result is the median: wall time,
and processor time of all threads and of finished processes, which other programs on the machine
disturb less. A call that did not do all that its name says is an error. Commands on empty caches, and
the longest ones, are made once.
"""

import itertools
import os
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from xarray import Dataset

from tipoff.files import write_json
from tipoff.mechanics.rail_compliance import MODES, RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.scene import Scene, load
from tipoff.studies.render.table import Column, Table
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from validation.bench import done
from validation.bench.methods import varied

LENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)  # m, of rails whose compliance is timed
_ELEMENT = 2e-3  # m, of these rails
SLOTS = (1.0, 2.0, 4.0, 8.0, 12.0)  # m, of T-slot rails
_SLOT_ELEMENT, _APART = 2e-2, 0.78  # m: of these rails, and from one of their mounts to the next
_LONG = 1.2  # m, of the rails of a run with all modes
_LOG_ROWS = 100_000
_CASES = 2000


@dataclass(frozen=True)
class Wait:
    """One row."""

    call: str
    wall_ms: float
    cpu_ms: float
    repeats: int
    file_mb: float | None = None  # of a rail compliance


def run(
    out: Path,
    repeats: int = 15,
    lengths: tuple[float, ...] = LENGTHS,
    slots: tuple[float, ...] = SLOTS,
    cold: bool = False,
) -> dict:
    """``rows``, one for each call; writes ``out``/bench/waits.json. With ``cold``, also the first
    run, the first report and ``limits``, which take half an hour."""
    rows: list[Wait] = []
    for group in (_calls, _files, _shell):
        with TemporaryDirectory() as folder:
            rows += _by_turns(group(Path(folder)), repeats)
    rows += [_rail(length) for length in lengths] + [_slot(length) for length in slots]
    if cold:
        with TemporaryDirectory() as folder:
            rows += [_once(name, call) for name, call in _cold(Path(folder)).items()]
    found = {
        "rows": [asdict(row) for row in rows],
        "hardware": machine.describe(),
        "state": machine.state(),
    }
    write_json(Path(out) / "bench" / "waits.json", found)
    return found


def _by_turns(calls: dict[str, Callable[[], object]], repeats: int) -> list[Wait]:
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    for _ in range(repeats):
        for name, call in calls.items():
            times[name].append(_timed(name, call))
    found = []
    for name, pairs in times.items():
        wall, processor = (1e3 * statistics.median(each) for each in zip(*pairs))
        found.append(Wait(name, wall, processor, repeats))
        say(f"  {name}: {wall:.3g} ms")
    return found


def _once(name: str, call: Callable[[], object]) -> Wait:
    wall, processor = _timed(name, call)
    say(f"  {name}: {wall:.3g} s")
    return Wait(name, 1e3 * wall, 1e3 * processor, 1)


def _timed(name: str, call: Callable[[], object]) -> tuple[float, float]:
    """Wall time and processor time (s) of a call that does its work."""
    wall, processor = time.perf_counter(), _processor()
    found = call()
    spent = time.perf_counter() - wall, _processor() - processor
    require_whole(name, found)
    return spent


def require_whole(name: str, found: object) -> None:
    """Raise NotDone for a result ``found`` of the call ``name`` that lacks a part: a run or a case
    that did not settle, a file that is not there, or a rail compliance without its uncertainty. A command
    that fails raises an error of its own."""
    if isinstance(found, Trajectory):
        done.require(f"runs in '{name}'", done.runs([found]), 1)
    elif isinstance(found, Dataset):
        done.require(f"cases in '{name}'", done.rates(found), _CASES)
    elif isinstance(found, Path):
        done.require(f"files of '{name}'", found.is_file(), True)
    elif isinstance(found, RailCompliance) and found.not_known:
        raise done.NotDone(f"{name}: its uncertainty is not known: {found.not_known}")


def _processor() -> float:
    """Processor time (s) of this process and of its finished children."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def _calls(folder: Path) -> dict[str, Callable[[], object]]:
    """Single runs and an ensemble; 20 scenes are a loop over them, one after another."""
    import tipoff

    scene = load("reference").condition("phi35")
    rail = tipoff.compliance(scene)
    scenes = [load("reference").replace(row) for row in varied(20)]
    another, cases = itertools.cycle(scenes), varied(_CASES, seed=7)
    long = long_rail(_LONG).replace({"duration": None})  # until its rates have settled
    long_walls = tipoff.compliance(long, 4.0 * _ELEMENT)
    run = partial(tipoff.run, sensitivity=False)  # one run, without those that disturb it
    return {
        "run": lambda: run(scene),
        "run of another of 20 scenes": lambda: run(next(another)),
        "run, compliance given": lambda: run(scene, compliance=rail),
        "run, compliance given, no modes": lambda: run(scene, compliance=rail, modes=0),
        "run on springs": lambda: run(scene, "springs"),
        f"run on {_LONG:g} m with {MODES} modes": lambda: run(
            long, compliance=long_walls, modes=MODES
        ),
        f"ensemble of {_CASES:,}": lambda: tipoff.ensemble(load("reference"), cases, "compliant"),
    }


def _files(folder: Path) -> dict[str, Callable[[], object]]:
    """Files of results and of a thrust log."""
    import tipoff

    ended = tipoff.run(load("reference").condition("phi35"), "springs")
    path, log = folder / "run.nc", folder / "thrust.csv"
    at = np.linspace(0.0, 0.05, _LOG_ROWS - 1)
    force = 3e4 * np.exp(-0.5 * ((at - 0.012) / 0.004) ** 2)
    rows = (f"{time:.9f},{newton:.6f}\n" for time, newton in zip(at, force))
    text, numbers = "time_s,force_N\n" + "".join(rows), itertools.count(1)

    def saved() -> Path:
        path.unlink(missing_ok=True)
        ended.save(path)
        return path

    def with_log() -> Scene:
        # another last row each time: a curve that was read before is not read again
        log.write_text(f"{text}0.06,{next(numbers)}\n", encoding="utf-8")
        return load("tiny").replace({"thrust": {"kind": "measured", "file": str(log)}})

    return {
        "Trajectory.save": saved,
        "Trajectory.load": lambda: tipoff.Trajectory.load(path),
        f"scene with a new thrust log of {_LOG_ROWS:,} rows": with_log,
    }


def _shell(folder: Path) -> dict[str, Callable[[], object]]:
    """Commands in processes of their own. Their results exist and nothing changed."""
    return {"shell: tipoff run, nothing changed": _command(folder, "run", "--scene", "tiny")}


def _cold(folder: Path) -> dict[str, Callable[[], object]]:
    """Commands in processes of their own, the first two on empty caches."""
    return {
        "shell: first tipoff run": _command(folder / "run", "run", caches=folder / "first"),
        "shell: first tipoff report": _command(
            folder / "report", "report", caches=folder / "second"
        ),
        "shell: tipoff limits": _command(folder / "report", "limits"),
    }


def _command(out: Path, *words: str, caches: Path | None = None) -> Callable[[], object]:
    """A call of ``tipoff`` with results in ``out`` and kernels in ``caches``, by default those of
    this process."""
    environment = os.environ | ({"NUMBA_CACHE_DIR": str(caches)} if caches else {})
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # an installed package has its bytecode
    line = [sys.executable, "-m", "tipoff", *words, "--out", str(out)]
    return lambda: subprocess.run(line, check=True, capture_output=True, env=environment)


def _rail(length: float) -> Wait:
    """Compliance of a rail of the reference of this ``length`` (m), with its uncertainty."""
    from tipoff.calibration import rail_compliance

    scene = long_rail(length)
    name = f"compliance, {length:g} m in {1e3 * _ELEMENT:g} mm elements"
    return _compliance(name, lambda: rail_compliance.compliance(scene, _ELEMENT))


def _slot(length: float) -> Wait:
    """Compliance of a T-slot rail of this ``length`` (m), without its uncertainty."""
    from tipoff import highfi

    scene = long_slot(length)
    name = f"compliance, {length:g} m of T-slot in {1e3 * _SLOT_ELEMENT:g} mm elements"
    return _compliance(name, lambda: highfi.condense(scene, _SLOT_ELEMENT))


def _compliance(name: str, call: Callable[[], RailCompliance]) -> Wait:
    found: list[RailCompliance] = []

    def kept() -> RailCompliance:
        found.append(call())
        return found[0]

    row = _once(name, kept)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "compliance.npz"
        found[0].save(path)
        return replace(row, file_mb=1e-6 * path.stat().st_size)


def long_rail(length: float) -> Scene:
    """The reference scene on rails of this ``length`` (m), with mounts every 0.1 m."""
    scene = load("reference")
    assert isinstance(scene.rail, SectionTable)  # of this scene
    first, *_ = scene.rail.mounts
    starts = np.arange(first.start, scene.rail.start + length - 0.02, 0.1)
    mounts = [{"start": float(start), "end": float(start) + 0.02} for start in starts]
    return scene.replace({"rail.end": scene.rail.start + length, "rail.mounts": mounts})


def long_slot(length: float) -> Scene:
    """The scene ``rocket_rail`` on a rail of this ``length`` (m), with at least three mounts."""
    scene = load("rocket_rail")
    count = max(3, round(length / _APART) + 1)
    middles = np.linspace(0.09, length - 0.27, count)
    mounts = [{"start": float(at - 0.03), "end": float(at + 0.03)} for at in middles]
    ends = {"rail.end": scene.rail.start + length, "rail.mounts": mounts}
    return scene.replace(ends | {"duration": 30.0})


def table(found: dict, earlier: dict | None = None) -> Table:
    """The rows, beside those of an ``earlier`` result on the same machine."""
    before = {row["call"]: row for row in (earlier or {}).get("rows", ())}
    rows = [
        row | {"before_ms": before.get(row["call"], {}).get("wall_ms")} for row in found["rows"]
    ]
    columns = (
        ("what is awaited", "call"),
        *((((Column("before", "ms", ".3g")), "before_ms"),) if before else ()),
        (Column("wall", "ms", ".3g"), "wall_ms"),
        (Column("processor", "ms", ".3g"), "cpu_ms"),
        (Column("file", "MB", ".3g"), "file_mb"),
        (Column("repeats", form="d"), "repeats"),
    )
    note = (
        "Medians of calls by turns, kernels compiled and caches warm; a compliance is computed "
        f"once. Machine: {found['hardware']['cores']} cores of {found['hardware']['processor']}."
    )
    return Table.of(rows, columns, notes=(note,))
