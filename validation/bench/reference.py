"""Speed of the reference solver and of its baseline (``csr_loop``), in turn on the same mesh.

Times are wall times of whole steps with contact: each repeat starts with eight pad faces pressed
1 um into their walls and ends before they separate. Compilation and set-up are excluded; results
are medians of the repeats.
"""

import resource
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tipoff.files import content_hash, write_json
from tipoff.highfi.dynamics.checkpoint import arrays
from tipoff.scenes.scene import Scene, load
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from tipoff.workspace.study import read

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
        f"{row['ns_free']:.2f} without; {row['ns_one_thread']:.2f} on one thread; SciPy and NumPy "
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
    pieces: dict[str, tuple[Callable[[int], None], int, int]] = {
        name: (_Again(loop), count, elements) for name, loop in loops.items()
    }
    pieces["baseline"] = (baseline.advance, max(3, count // 50), baseline.elements)
    times: dict[str, list[float]] = {name: [] for name in pieces}
    for _ in range(repeats):
        for name, (advance, number, size_of_it) in pieces.items():
            times[name].append(1e9 * _timed(advance, number) / size_of_it)
    median = {name: statistics.median(values) for name, values in times.items()}
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
        "repeats": repeats,
        "faces_in_contact": int((np.abs(state.face_force).max(axis=1) > 0.0).sum()),
        "set_up_s": set_up_time,
        "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
        "dt_s": stepping.dt_s,
        "dt_element_s": stepping.dt_element_s,
        "projected_40_ms_s": 0.04 / stepping.dt_s * 1e-9 * median["pressed"] * elements,
        "hardware": machine.describe(),
    }


class _Again:
    """Makes steps of a loop; ``rewind`` returns to its start."""

    def __init__(self, loop):
        self.loop = loop
        evolving = {"state": loop.stepper.state, "active": loop.stepper.active}
        self.evolving = [array for _, array in arrays(evolving)]
        self.start = [array.copy() for array in self.evolving]

    def __call__(self, count: int) -> None:
        self.loop.advance_steps(count)

    def rewind(self) -> None:
        """Back to the start."""
        for array, value in zip(self.evolving, self.start):
            array[...] = value
        self.loop.stepper.steps = 0


def _timed(advance: Callable[[int], None], count: int) -> float:
    """Seconds per step with warm caches."""
    advance(max(1, count // 10))
    if isinstance(advance, _Again):
        advance.rewind()
    began = time.perf_counter()
    advance(count)
    return (time.perf_counter() - began) / count


def memory(*records) -> int:
    """Bytes of all arrays in nested records."""
    return sum(
        item.nbytes if isinstance(item, np.ndarray) else memory(*item)
        for item in records
        if isinstance(item, (np.ndarray, tuple))
    )
