"""Speed of the reference solver against the loop an engineer would write today, by turns on the same mesh in one run.

Times are wall times of whole steps with contact on: the payload starts one micrometre deep in the walls of one corner of all eight
pads, so that contact is computed and not only searched. Compilation and set-up are apart; the median of the repeats counts.
"""

import statistics
import time
from pathlib import Path
from typing import Callable

import numpy as np

from scenes.files import write_json
from scenes.scene import Scene, load
from studies import machine
from studies.progress import say

SIZES = (0.002, 0.001, 0.0005)  # m: 19,360, 154,880 and 1,239,040 elements of the reference rails
_BASELINE_MOST = 160_000  # elements whose assembly fits into memory with room to spare; a larger matrix is no faster per element
_WORK = 4e7  # elements times steps in one timed piece


def pressed(scene: Scene) -> Scene:
    """``scene`` with the payload set 1 um deep into its +y and +z walls."""
    depth = scene.contact.clearance + 1e-6
    return scene.replace({"initial.position.y": depth, "initial.position.z": depth})


def run(out: Path, sizes: tuple[float, ...] = SIZES, repeats: int = 5) -> dict:
    """``rows``, one per size; also written to ``out``/bench/highfi.json."""
    scene = pressed(load("reference").condition("phi35"))
    rows = []
    for size in sizes:
        rows.append(_measured(scene, size, repeats))
        say(line(rows[-1]))
        write_json(Path(out) / "bench" / "highfi.json", rows)
    return {"rows": rows}


def line(row: dict) -> str:
    """One row in words."""
    return (f"  {row['elements']:>9,} elements: {row['ns_per_element_step']:.2f} ns per element and step on {row['threads']} threads, "
            f"{row['ns_one_thread']:.2f} on one; SciPy and NumPy {row['baseline_ns_per_element_step']:.0f}, "
            f"{row['ratio']:.0f} times as much; set-up {row['set_up_s']:.1f} s; {row['bytes_per_element']:.0f} bytes per element")


def _measured(scene: Scene, size: float, repeats: int) -> dict:
    from highfi import Numerics, prepare
    from highfi.run import Loop
    from highfi.stepping import choose
    from highfi.system import build
    from highfi.team import processors
    from studies.csr_loop import CsrLoop

    numerics, began = Numerics(element_size=size), time.perf_counter()
    system = build(scene, numerics, prepare(scene, numerics))
    stepping = choose(system, scene, numerics)
    set_up = time.perf_counter() - began
    alone, together = (Loop(scene, system, stepping, threads) for threads in (1, processors()))
    for loop in (alone, together):
        loop.begin()
    elements = len(system.operator.hexes)
    baseline = CsrLoop(system.mesh, scene.rail.material, stepping.dt_s, _BASELINE_MOST)
    count = max(20, round(_WORK / elements))
    times = {"alone": [], "together": [], "baseline": []}
    for _ in range(repeats + 1):
        times["together"].append(_timed(together.advance_steps, count) / elements)
        times["alone"].append(_timed(alone.advance_steps, max(10, count // 2)) / elements)
        times["baseline"].append(_timed(baseline.advance, max(3, count // 50)) / baseline.elements)
    # The first of each warms the caches.
    together_ns, alone_ns, baseline_ns = (1e9 * statistics.median(values[1:]) for values in (
        times["together"], times["alone"], times["baseline"]))
    faces = int((np.abs(together.state.face_force).max(axis=1) > 0.0).sum())
    return {"elements": elements, "element_size_m": size, "threads": together.team.size, "ns_per_element_step": together_ns,
            "ns_one_thread": alone_ns, "baseline_ns_per_element_step": baseline_ns, "ratio": baseline_ns / together_ns,
            "baseline_elements": baseline.elements, "bytes_per_element": memory(system, together.state) / elements,
            "range_ns": [1e9 * min(times["together"][1:]), 1e9 * max(times["together"][1:])], "steps_timed": count,
            "repeats": repeats, "faces_in_contact": faces, "set_up_s": set_up, "dt_s": stepping.dt_s,
            "dt_element_s": stepping.dt_element_s, "hardware": machine.describe()}


def _timed(advance: Callable[[int], None], count: int) -> float:
    """Seconds per step."""
    began = time.perf_counter()
    advance(count)
    return (time.perf_counter() - began) / count


def memory(*records) -> int:
    """Bytes of all arrays in records of records."""
    return sum(item.nbytes if isinstance(item, np.ndarray) else memory(*item) for item in records
               if isinstance(item, (np.ndarray, tuple)))
