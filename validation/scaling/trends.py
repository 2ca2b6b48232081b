"""Growth of time with the length of the rails, with the cases of an ensemble, and with threads.

    t = c n^p, as in ``scaling.growth``

Length: rails as long as several of the scene's end to end, with the mounts of each. The statics of a
rail treat it as a chain of layers, so the rail compliance has p = 1. Cases: p = 1, because cases share
nothing but the set-up. Threads: p = -1 for the wall time if no thread waits for another.
"""

import os
import time
from collections.abc import Callable, Sequence
from functools import partial

from tipoff.faults import SceneError
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.ensemble.threads import PIECE, completed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.scenes.rail_base import HeldBySpans
from tipoff.scenes.scene import Scene
from tipoff.workspace.compiling import warm_up
from tipoff.workspace.errors import FAILED
from tipoff.workspace.progress import Board
from tipoff.workspace.run import execute
from tipoff.workspace.study import Study
from tipoff.workspace.words import counted
from validation.bench import done
from validation.scaling.growth import coarse_walls, power_law
from validation.scaling.results import Trend

_LENGTHS = (1, 2, 4)  # of the scene's rails
_CASES = (256, 1024, 4096)
_TOLERANCE = 1e-2  # of studies with many cases


def measured(study: Study, name: str) -> tuple[Trend, ...]:
    """The trends of the condition ``name``; without contact there is no rail compliance, and a rail
    from a file has one length."""
    with Board("growth, trends", 4) as board:
        found = [
            _over_length(study, name, board),
            *_over_cases_and_threads(study, name, board),
            _of_reference_over_threads(study, name, board),
        ]
    return tuple(trend for trend in found if trend is not None)


def lengthened(scene: Scene, factor: int) -> Scene | None:
    """``scene`` with rails ``factor`` times as long, and the mounts of that many rails; None for
    rails from a file, and for mounts that would overlap."""
    rail = scene.rail
    if not isinstance(rail, HeldBySpans):
        return None
    length = rail.end - rail.start
    mounts = [
        {"start": mount.start + number * length, "end": mount.end + number * length}
        for number in range(factor)
        for mount in rail.mounts
    ]
    try:
        return scene.replace({"rail.end": rail.start + factor * length, "rail.mounts": mounts})
    except SceneError:
        return None


def _over_length(study: Study, name: str, board: Board) -> Trend | None:
    from tipoff import highfi

    scenes = [lengthened(study.condition(name), factor) for factor in _LENGTHS]
    rails = [scene for scene in scenes if scene is not None and scene.contact is not None]
    if len(rails) < 2:
        return None
    size = 2.0 * study.settings.coarse_size
    times = seconds(
        [partial(highfi.condense, scene, element_size=size) for scene in rails],
        time.process_time,
    )
    board.finished("rail compliance", f"{len(rails)} lengths timed")
    lengths = [scene.rail.end - scene.rail.start for scene in rails]
    return _trend("rail compliance", "length of the rails (m)", lengths, times, 1.0)


def _over_cases_and_threads(study: Study, name: str, board: Board) -> list[Trend]:
    scene = study.condition(name)
    walls = coarse_walls(study, name, {}) if scene.contact is not None else None
    family = Family(scene, None, Numerics.of_many(_TOLERANCE, 0), walls)
    mass = scene.payload.mass
    rows = [{"payload.mass": mass * (1.0 + 1e-6 * number)} for number in range(_CASES[-1])]

    def call(count: int, threads: int) -> Callable[[], object]:
        pieces = [rows[begin : min(begin + PIECE, count)] for begin in range(0, count, PIECE)]

        def run() -> None:
            found = [case for piece in completed(family, pieces, threads) for case in piece]
            stepped = sum(case.steps > 0 and case.status not in FAILED for case in found)
            done.require(f"cases on {counted(threads, 'thread')}", stepped, count)

        return run

    call(1, 1)()  # compiles its kernels
    of_cases = seconds([call(count, 1) for count in _CASES], time.process_time)
    board.finished("ensemble", f"{len(_CASES)} numbers of cases timed")
    threads = thread_counts()
    of_threads = seconds([call(_CASES[-1], number) for number in threads], time.perf_counter)
    board.finished("ensemble, threads", f"up to {threads[-1]} threads timed")
    task = f"ensemble, {COMPLIANT}" if walls is not None else "ensemble"
    return [
        _trend(task, "cases", _CASES, of_cases, 1.0),
        _trend(task, "threads", threads, of_threads, -1.0),
    ]


def _of_reference_over_threads(study: Study, name: str, board: Board) -> Trend:
    run, threads = study.coarse(name), thread_counts()
    warm_up(run)

    def call(number: int) -> Callable[[], object]:
        def once() -> None:
            found = execute(run, None, number)
            done.require_run(
                f"finite elements on {counted(number, 'thread')}", found, settles=False
            )
            ends.add((found.status, int(found.cost["steps"])))
            done.require("ends of equal runs", len(ends), 1)

        return once

    ends: set[tuple[str, int]] = set()
    times = seconds([call(number) for number in threads], time.perf_counter)
    board.finished(FINITE_ELEMENTS, f"up to {threads[-1]} threads timed")
    return _trend(FINITE_ELEMENTS, "threads", threads, times, -1.0)


def thread_counts() -> list[int]:
    """Powers of two up to the processors of the machine."""
    count = os.cpu_count() or 1
    return [2**power for power in range(count.bit_length())]


def seconds(calls: Sequence[Callable[[], object]], clock: Callable[[], float]) -> list[float]:
    """Seconds of each call by ``clock``: the shorter of two rounds."""

    def one(call: Callable[[], object]) -> float:
        began = clock()
        call()
        return clock() - began

    rounds = [[one(call) for call in calls] for _ in range(2)]
    return [min(times) for times in zip(*rounds)]


def _trend(
    task: str, size: str, sizes: Sequence[float], times: Sequence[float], expected: float
) -> Trend:
    return Trend(
        task=task,
        size=size,
        sizes=tuple(map(float, sizes)),
        times_s=tuple(times),
        law=power_law(sizes, times),
        expected=expected,
    )
