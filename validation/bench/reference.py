"""Speed of the reference solver and of its baseline (``csr_loop``), in turn on the same mesh.

Times are wall times of whole steps with contact: each repeat starts with eight pad faces pressed
1 um into their walls and ends before they separate. Friction of pads at rest divides steps into
substeps, as in any run, and each of them steps all elements. So a time is divided by the elements that
were stepped, which the loop counts. A repeat that made other steps than those asked for is an error, and
so is a time that no machine reaches. Compilation and set-up are excluded; results are medians of the
repeats.
"""

import resource
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tipoff.files import content_hash, write_json
from tipoff.highfi.dynamics import checkpoint, substeps
from tipoff.scenes.scene import Scene, load
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from tipoff.workspace.study import read
from validation.bench import done

SIZES = (0.002, 0.001, 0.0005)  # m: 19,360, 154,880 and 1,239,040 elements of the reference rails
# largest number of elements of the baseline, whose matrix fits into memory; more are no faster per
# element
_BASELINE_MOST = 160_000
_WORK = 4e7  # elements times steps of one timed repeat
_PRESSED = 1e-4  # s, shorter than the contact


def pressed(scene: Scene) -> Scene:
    """``scene`` with the payload pressed 1 um into its +y and +z walls."""
    assert scene.contact is not None
    depth = scene.contact.clearance + 1e-6
    return scene.replace({"initial.position.y": depth, "initial.position.z": depth})


def run(
    out: Path, sizes: tuple[float, ...] = SIZES, repeats: int = 5, steps: int | None = None
) -> dict:
    """``rows``, one for each element size (m), from repeats of ``steps`` steps; writes
    ``out``/bench/highfi.json."""
    scene = load("reference").condition("phi35")
    rows = []
    for size in sizes:
        rows.append(_measured(scene, size, repeats, steps))
        say(line(rows[-1]))
        write_json(Path(out) / "bench" / "highfi.json", {"rows": rows})
    return {"rows": rows}


def stored(out: Path) -> dict | None:
    """The stored ``rows``, the stored result of the surrogate (``lowfi``), and their digest,
    ``key``; None without either."""
    found = {
        name: kept
        for name in ("highfi", "lowfi")
        if (kept := read(Path(out) / "bench" / f"{name}.json")) is not None
    }
    if not found:
        return None
    return {
        "rows": found.get("highfi", {}).get("rows", []),
        "lowfi": found.get("lowfi"),
        "key": content_hash(found),
    }


def line(row: dict) -> str:
    """One row as text."""
    return (
        f"  {row['elements']:>9,} elements: {row['ns_per_element_step']:.2f} ns per element and "
        f"step on {row['threads']} threads with {row['faces_in_contact']} faces pressed, "
        f"{row['ns_free']:.2f} without; {row['ns_one_thread']:.2f} on one thread; {row['steps_timed']:,} "
        f"steps timed, with faces pressed in {row['times_stepped']['pressed']:,} parts; SciPy and NumPy "
        f"{row['baseline_ns_per_element_step']:.0f}, {row['ratio']:.0f} times as much; set-up "
        f"{row['set_up_s']:.1f} s; {row['bytes_per_element']:.0f} bytes per element; projected run "
        f"of 40 ms: {row['projected_40_ms_s'] / 3600.0:.2g} h"
    )


def _measured(scene: Scene, size: float, repeats: int, steps: int | None) -> dict:
    from tipoff.highfi import Numerics, prepare
    from tipoff.highfi.dynamics.setup import set_up
    from tipoff.highfi.dynamics.step_size import choose
    from tipoff.highfi.dynamics.system import build
    from tipoff.highfi.simulation import Loop
    from tipoff.highfi.state.threads import processors
    from validation.bench.csr_loop import CsrLoop

    numerics, began = Numerics(element_size=size), time.perf_counter()
    touching, mesh = pressed(scene), prepare(scene, numerics)
    system = build(touching, numerics, mesh)
    stepping = choose(system, touching, numerics)
    loops = {
        "pressed": Loop(set_up(touching, system, stepping, processors())),
        "alone": Loop(set_up(touching, system, stepping, 1)),
        "free": Loop(set_up(scene, build(scene, numerics, mesh), stepping, processors())),
    }
    set_up_time = time.perf_counter() - began
    for loop in loops.values():
        loop.begin()
    baseline = CsrLoop(mesh, scene.rail.material, stepping.dt_s, _BASELINE_MOST)
    elements = len(mesh.cells)
    count = steps or max(20, min(round(_WORK / elements), int(_PRESSED / stepping.dt_s)))
    pieces: dict[str, tuple[Callable[[int], int], int, int]] = {
        name: (Again(loop), count, elements) for name, loop in loops.items()
    }
    pieces["baseline"] = (baseline.advance, max(3, count // 50), baseline.elements)
    times: dict[str, list[float]] = {name: [] for name in pieces}
    stepped = dict.fromkeys(pieces, 0)
    for _ in range(repeats):
        for name, (advance, number, size_of_it) in pieces.items():
            seconds, stepped[name] = _timed(advance, number)
            times[name].append(1e9 * seconds / (stepped[name] * size_of_it))
    median = {name: statistics.median(values) for name, values in times.items()}
    for name, value in median.items():
        together = 1 if name in ("alone", "baseline") else processors()
        done.require_at_least(f"ns per element and step, {name}", value * together, done.SHORTEST)
    state, threads = loops["pressed"].stepper.state, loops["pressed"].setup.team.size
    return {
        "elements": elements,
        "element_size_m": size,
        "threads": threads,
        "ns_per_element_step": median["pressed"],
        "ns_free": median["free"],
        "ns_one_thread": median["alone"],
        "baseline_ns_per_element_step": median["baseline"],
        "ratio": median["baseline"] / median["pressed"],
        "baseline_elements": baseline.elements,
        "bytes_per_element": memory(system, state) / elements,
        "range_ns": [min(times["pressed"]), max(times["pressed"])],
        "steps_timed": count,
        "times_stepped": stepped,
        "repeats": repeats,
        "faces_in_contact": int((np.abs(state.face_force).max(axis=1) > 0.0).sum()),
        "set_up_s": set_up_time,
        "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
        "dt_s": stepping.dt_s,
        "dt_element_s": stepping.dt_element_s,
        "projected_40_ms_s": 0.04 / stepping.dt_s * 1e-9 * median["pressed"] * elements,
        "hardware": machine.describe(),
        "state": machine.state(),
    }


class Again:
    """Makes steps of a loop, with all rails ``stepped`` or none; ``rewind`` returns to its start."""

    def __init__(self, loop, stepped: bool = True):
        self.loop = loop
        self.nodes = int(loop.setup.system.rail.blocks[-1]) if stepped else 0
        self.start = {
            name: array.copy() for name, array in checkpoint.arrays(checkpoint.evolving(loop))
        }

    def __call__(self, count: int) -> int:
        """Make ``count`` steps; returns how many times all elements were stepped. Raises NotDone for
        other steps."""
        stepper, recorded = self.loop.stepper, self.loop.recorded
        steps, parts, nodes, taken = stepper.steps, recorded.parts, recorded.node_steps, 1
        while taken and stepper.steps - steps < count:
            taken = stepper.steps
            left = min(count - (taken - steps), substeps.adapt(stepper))
            self.loop.advance_steps(left)
            taken = stepper.steps - taken
        done.require("steps of the reference", stepper.steps - steps, count)
        parts = recorded.parts - parts
        done.require("nodes that were stepped", recorded.node_steps - nodes, parts * self.nodes)
        return parts

    def rewind(self) -> None:
        """Back to the start: state, clock, substeps and counts."""
        checkpoint.restore(self.loop, self.start)


def _timed(advance: Callable[[int], int], count: int) -> tuple[float, int]:
    """Seconds of ``count`` steps with warm caches, and how many times they stepped all elements."""
    advance(max(1, count // 10))
    if isinstance(advance, Again):
        advance.rewind()
    began = time.perf_counter()
    stepped = advance(count)
    return time.perf_counter() - began, stepped


def memory(*records) -> int:
    """Bytes of all arrays in nested records."""
    return sum(
        item.nbytes if isinstance(item, np.ndarray) else memory(*item)
        for item in records
        if isinstance(item, (np.ndarray, tuple))
    )
