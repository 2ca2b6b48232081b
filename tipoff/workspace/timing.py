"""Timed runs: the same case in both fidelities, alternately in one process, without compilation.

    ratio = median wall time of highfi.run / median wall time of lowfi.run

``low`` and ``high`` are the smallest and the largest ratio of any pair of repeats. Every repeat of a model
must end as the first one did, after as many steps.
"""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tipoff.results.trajectory import Trajectory
from tipoff.workspace import machine
from tipoff.workspace.compiling import warm_up
from tipoff.workspace.errors import FAILED, StudyError
from tipoff.workspace.run import Run, execute
from tipoff.workspace.words import counted


@dataclass(frozen=True, kw_only=True)
class Speedup:
    """Medians and ranges of wall times (s) on one ``condition``, their ``ratio``; that of the time loops
    alone and of processor times, None where a time is not known; whether all repeats have equal bits,
    None without repeats."""

    condition: str
    ratio: float
    low: float
    high: float
    highfi_wall_s: float
    lowfi_wall_s: float
    highfi_wall_range_s: tuple[float, float]
    lowfi_wall_range_s: tuple[float, float]
    elements: int
    highfi_repeats: int
    lowfi_repeats: int
    kernel_ratio: float | None
    cpu_ratio: float | None
    repeats_identical: bool | None
    hardware: dict


def timed(
    run: Run, progress: Callable[[float], None] | None = None
) -> tuple[Trajectory, float, float]:
    """Result, wall seconds and processor seconds of one run, both without compilation."""
    wall, processor = time.perf_counter(), time.process_time()
    found = execute(run, progress)
    compiling = found.cost["compile_s"]
    return (
        found,
        time.perf_counter() - wall - compiling,
        time.process_time() - processor - compiling,
    )


def speedups(
    highfi: Run,
    surrogates: dict[str, Run],
    highfi_repeats: int,
    lowfi_repeats: int,
    progress: Callable[[float], None] = lambda fraction: None,
) -> dict[str, Speedup]:
    """Speed of the reference and of each surrogate for one case; ``lowfi_repeats`` runs of each
    surrogate follow each of the ``highfi_repeats`` reference runs."""
    for run in (highfi, *surrogates.values()):
        warm_up(run)
    slow: list = []
    fast: dict[str, list] = {name: [] for name in surrogates}

    def part(repeat: int) -> Callable[[float], None]:
        return lambda fraction: progress((repeat + fraction) / highfi_repeats)

    for repeat in range(highfi_repeats):
        slow.append(timed(highfi, part(repeat)))
        for name, run in surrogates.items():
            fast[name] += [timed(run) for _ in range(lowfi_repeats)]
    return {name: _speedup(highfi.label, slow, found) for name, found in fast.items()}


def _require_equal_work(name: str, runs: list[Trajectory]) -> None:
    """Raise StudyError if a run failed or did not end as the others, because its time is then not
    that of the others."""
    ends = sorted({(run.status, int(run.cost["steps"])) for run in runs})
    if len(ends) > 1 or ends[0][0] in FAILED or not ends[0][1] > 0:
        words = "; ".join(f"{status} after {counted(steps, 'step')}" for status, steps in ends)
        raise StudyError(f"{name}: its repeats cannot be timed: {words}")


def _speedup(condition: str, slow: list, fast: list) -> Speedup:
    for name, runs in (("reference", slow), ("surrogate", fast)):
        _require_equal_work(f"{condition}, {name}", [run for run, _, _ in runs])
    slow_wall, fast_wall = [wall for _, wall, _ in slow], [wall for _, wall, _ in fast]
    slow_median, fast_median = statistics.median(slow_wall), statistics.median(fast_wall)
    return Speedup(
        condition=condition,
        ratio=slow_median / fast_median,
        low=min(slow_wall) / max(fast_wall),
        high=max(slow_wall) / min(fast_wall),
        highfi_wall_s=slow_median,
        lowfi_wall_s=fast_median,
        highfi_wall_range_s=(min(slow_wall), max(slow_wall)),
        lowfi_wall_range_s=(min(fast_wall), max(fast_wall)),
        elements=slow[0][0].cost["elements"],
        highfi_repeats=len(slow),
        lowfi_repeats=len(fast),
        kernel_ratio=_median_ratio(
            [run.cost.get("kernel_s") for run, _, _ in slow],
            [run.cost.get("kernel_s") for run, _, _ in fast],
        ),
        cpu_ratio=_median_ratio([cpu for _, _, cpu in slow], [cpu for _, _, cpu in fast]),
        repeats_identical=_identical([[run for run, _, _ in runs] for runs in (slow, fast)]),
        hardware=machine.describe(),
    )


def _identical(repeats: list[list[Trajectory]]) -> bool | None:
    """Whether all repeats of each model agree in every bit of their motion; None without any."""
    pairs = [(run, first) for first, *others in repeats for run in others]
    if not pairs:
        return None
    return all(
        np.array_equal(getattr(run, name), getattr(first, name))
        for run, first in pairs
        for name in ("velocity", "rate", "quaternion", "pad_force", "transverse_energy")
    )


def _median_ratio(slow: list, fast: list) -> float | None:
    if None in slow or None in fast or statistics.median(fast) <= 0.0:
        return None
    return statistics.median(slow) / statistics.median(fast)
