"""Compile kernels in parallel processes, before the runs that need them.

In one process Numba compiles one kernel at a time, so threads that make runs with different kernels
would wait for each other.
"""

import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

from tipoff.workspace import kernel_marks
from tipoff.workspace.progress import Board, say
from tipoff.workspace.run import Run, execute, prepare


def warm_up(run: Run) -> None:
    """Compile or load the kernels of ``run`` by its first milliseconds. A run that chooses its
    modes of the rails begins without modes; kernels with modes are compiled when they are
    needed."""
    prepare(run)
    scene = run.scene
    first = min(scene.time_limit, max(scene.output.interval, 1e-3))
    with kernel_marks.rare_collections():
        execute(replace(run, scene=scene.replace({"duration": first})))


def compile_ahead(title: str, runs: Sequence[Run], workers: int) -> None:
    """Compile the kernels of ``runs`` that no earlier call has compiled, ``workers`` at a time,
    with progress under ``title`` on standard error.

    Runs with the same kernels count as one. With one worker, or one kernel, this
    does nothing: the run compiles its kernel itself, and so does one whose warm-up fails. The same
    in a script of the user, because each process would begin by running the script again.
    """
    named = {kernel_marks.mark(run): run for run in reversed(runs)}
    missing = {mark: run for mark, run in named.items() if not kernel_marks.are_there(run)}
    if min(workers, len(missing)) < 2 or _is_script():
        return
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
    try:
        with Board(title, len(missing)) as board:
            pending = {}
            for run in missing.values():
                board.callback(run.label)(0.0)
                pending[pool.submit(warm_up, run)] = run
            for future in as_completed(pending):
                run = pending[future]
                try:
                    future.result()
                except BrokenProcessPool:
                    raise
                except Exception as fault:  # a fault of the run itself is its own to report
                    board.finished(run.label, f"not compiled ahead ({fault})")
                else:
                    kernel_marks.remember(run)
                    board.finished(run.label, "compiled")
    except BrokenProcessPool:
        say("  a process that compiled kernels was ended; the runs compile their own")
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _is_script() -> bool:
    """Whether the program is a script other than the command, so not a module or a session."""
    main = sys.modules["__main__"]
    path = getattr(main, "__file__", None)
    return path is not None and main.__spec__ is None and Path(path).stem != "tipoff"
