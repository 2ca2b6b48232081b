"""Parts of one step of the finite elements: processor time of one thread while all rails are stepped.

A part is the difference of two times: of steps with it and without it. Pads are pressed as in
``reference``; without contact, every face waits; without joints, the rails have none under any node;
without stepped rails, only bodies, loads and ledgers are left. Elements are timed by themselves, and the
motion of the nodes is the rest. A sample, with its checks, is divided by the steps from one to the next.
Each repeat gives all times by turns, and so each difference; half the range of the differences is the error
of a part. A part below its error is not resolved.

Eight pressed faces are the most that contact can cost. In a run of ``reference`` a third of one face is
pressed in the mean, and contact takes 3 to 5 us of a step in which rails are stepped. At 8 mm its mounts
do not fit equal layers. Columns with layers of two lengths have a third more products per element.
"""

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tipoff.files import write_json
from tipoff.highfi.dynamics import substeps
from tipoff.scenes.scene import load
from tipoff.studies.render.table import Cells, Column, Table
from tipoff.uncertain import Measured, rounded
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from validation.bench import done
from validation.bench.reference import Again, pressed

SIZES = (0.008, 0.004, 0.002, 0.001)  # m
_STEPS = 100  # of one timed repeat, shorter than the contact
_CALLS = 10  # of a function in one timed repeat
_NEVER = 2**40  # steps for which a face waits
_COLUMNS: Cells = (
    (Column("element size", "mm", "g", 1e3), "element_size_m"),
    ("elements", "elements"),
    *(
        (Column(title, "us"), lambda row, name=name: _part(row, name))
        for title, name in (
            ("one step", "step"),
            ("elements", "elements"),
            ("nodes", "nodes"),
            ("joints", "joints"),
            ("contact", "contact"),
            ("bodies, ledgers", "bodies"),
            ("samples, checks", "samples"),
        )
    ),
)


def run(out: Path, repeats: int, sizes: tuple[float, ...] = SIZES) -> dict:
    """``rows``, one for each element size (m), medians of ``repeats`` with their errors (us); writes
    ``out``/bench/parts.json."""
    rows = []
    for size in sizes:
        rows.append(_measured(size, repeats))
        say(f"  parts of a step at {1e3 * size:g} mm: done")
    found = {
        "rows": rows,
        "repeats": repeats,
        "hardware": machine.describe(),
        "state": machine.state(),
    }
    write_json(Path(out) / "bench" / "parts.json", found)
    return found


def table(found: dict) -> Table:
    """All rows."""
    note = (
        "Parts of one step of the finite elements with all rails stepped and eight pad faces pressed, "
        f"processor time of one thread, median and half the range of {found['repeats']} repeats of {_STEPS} steps. "
        "Samples and checks are divided by the steps from one sample to the next, and are not in the time of the step."
    )
    return Table.of(found["rows"], _COLUMNS, notes=(note,))


def _part(row: dict, name: str) -> Measured | str:
    """The time of a part with its error; its largest time in words if it is below the error."""
    value, error = row[f"{name}_us"], row[f"{name}_error_us"]
    if value < error:
        return f"at most {rounded(abs(value) + error, error)}"
    return Measured(value, error)


def _measured(size: float, repeats: int) -> dict:
    from tipoff.highfi import Numerics, prepare
    from tipoff.highfi.dynamics.setup import set_up
    from tipoff.highfi.dynamics.step_size import choose
    from tipoff.highfi.dynamics.system import build
    from tipoff.highfi.simulation import Loop

    numerics, scene = Numerics(element_size=size), pressed(load("reference").condition("phi35"))
    system = build(scene, numerics, prepare(scene, numerics))
    stepping = choose(system, scene, numerics)
    loop = Loop(set_up(scene, system, stepping, 1))
    loose = Loop(set_up(scene, system._replace(rail=_without_joints(system.rail)), stepping, 1))
    for each in (loop, loose):
        each.begin()
    calls = {
        "step": _steps(loop, lambda stepper: None),
        "free": _steps(loop, _wait),
        "loose": _steps(loose, _wait),
        "bodies": _steps(loose, _rest, stepped=False),
        "elements": _elements(loose),
        "sample": _sample(loop),
    }
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            times[name].append(1e6 * call())
    elements = len(system.mesh.cells)
    for name in ("step", "free", "loose", "elements"):
        spent = 1e3 * statistics.median(times[name]) / elements
        done.require_at_least(f"ns per element and step, {name}", spent, done.SHORTEST)
    spent_on = {name: np.array(values) for name, values in times.items()}
    parts = {
        "step": spent_on["step"],
        "elements": spent_on["elements"],
        "nodes": spent_on["loose"] - spent_on["bodies"] - spent_on["elements"],
        "joints": spent_on["free"] - spent_on["loose"],
        "contact": spent_on["step"] - spent_on["free"],
        "bodies": spent_on["bodies"],
        "samples": spent_on["sample"] / stepping.steps_per_sample,
    }
    found = {"element_size_m": size, "elements": elements, "steps_timed": _STEPS}
    for name, values in parts.items():
        found[f"{name}_us"] = float(np.median(values))
        found[f"{name}_error_us"] = 0.5 * float(np.ptp(values))
    return found


def _without_joints(rail):
    """``rail`` with joints under no node, so that the same compiled loop runs."""
    joints, none = rail.mounts, np.zeros(1, dtype=np.uint64)
    return rail._replace(
        mounts=joints._replace(first_node=np.zeros_like(joints.first_node), first=none)
    )


def _wait(stepper) -> None:
    # decides on substeps now, because another length of the step ends all waiting
    substeps.adapt(stepper)
    stepper.active.wait[:] = _NEVER


def _rest(stepper) -> None:
    _wait(stepper)
    stepper.state.stepped.in_use[0] = 0


def _steps(loop, change: Callable, stepped: bool = True) -> Callable[[], float]:
    """A call that gives the time (s) of a step from the start of ``loop`` on, after a ``change`` by which
    all rails are ``stepped`` or none. Raises NotDone for other steps, or steps of other rails."""
    again = Again(loop, stepped)

    def timed() -> float:
        again.rewind()
        change(loop.stepper)
        began = time.thread_time()
        parts = again(_STEPS)
        return (time.thread_time() - began) / parts

    return timed


def _elements(loop) -> Callable[[], float]:
    """A call that gives the time (s) of K u of all elements: of the function, less that of a call for
    none."""
    from tipoff.highfi.dynamics.elastic import elastic_force

    state, team, rail = loop.stepper.state, loop.setup.team, loop.setup.system.rail
    none = rail
    if rail.elements is not None:
        none = rail._replace(elements=rail.elements._replace(cells=rail.elements.cells[:0]))
    force = np.zeros_like(state.displacement)
    turn, joints = np.zeros_like(state.turning), np.zeros_like(state.mounting)

    def timed() -> float:
        spent = []
        for record, blocks in ((rail, len(turn)), (none, 0)):
            began = time.thread_time()
            for _ in range(_CALLS):
                elastic_force(record, state.displacement, force, turn[:blocks], joints, team)
            spent.append(time.thread_time() - began)
        return (spent[0] - spent[1]) / _CALLS

    return timed


def _sample(loop) -> Callable[[], float]:
    """A call that gives the time (s) of a sample with its checks."""
    from tipoff.highfi import faults

    stepper, recorded = loop.stepper, loop.recorded

    def timed() -> float:
        rows, began = len(recorded.rows), time.thread_time()
        for _ in range(_CALLS):
            row = stepper.sample()
            faults.fault(stepper, recorded, row)
            recorded.add_sample(stepper, row)
        spent = time.thread_time() - began
        done.require("samples", len(recorded.rows) - rows, _CALLS)
        return spent / _CALLS

    return timed
