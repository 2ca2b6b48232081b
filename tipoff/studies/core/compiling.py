"""Kernels compiled before the runs that need them, side by side in processes.

Numba compiles one kernel at a time in a process, so that threads which make runs with different
effects would wait for each other.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

from tipoff import sources
from tipoff.files import content_hash
from tipoff.kernels.jit import kernel_digest
from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.models import COMPLIANT
from tipoff.studies.core.progress import Board, say
from tipoff.studies.core.store import Run, execute, prepare

_COMPILES = {"highfi": "20 s", "lowfi": "20 s"}
_WITH_MODES = ", and a minute more if modes of the rails turn out to matter"


def warm_up(run: Run) -> None:
    """Compile or load the kernels of ``run`` by its first milliseconds."""
    prepare(run)
    execute(replace(run, scene=run.scene.replace({"duration": min(run.scene.duration, 1e-3)})))


@contextmanager
def first_use(run: Run, many: bool = False) -> Iterator[None]:
    """Announce the kernels of ``run``, or of ``many`` cases like it, and note that they are there
    once the block has used them."""
    announce(run, many)
    yield
    remember(run, many)


def announce(run: Run, many: bool = False) -> None:
    """Print that the kernels of ``run``, or of ``many`` cases like it, have to be compiled, where
    nothing has compiled them."""
    if not _mark(run, many).is_file():
        say(
            f"compiling the kernels of model {run.model} for these effects: about "
            f"{_COMPILES[run.fidelity]}, once" + (_WITH_MODES if _modes(run) == AUTO else "")
        )


def remember(run: Run, many: bool = False) -> None:
    """Note in the cache that the kernels of ``run``, or of ``many`` cases like it, are there."""
    mark = _mark(run, many)
    mark.parent.mkdir(parents=True, exist_ok=True)
    mark.touch()


def compile_ahead(title: str, runs: Sequence[Run], workers: int) -> None:
    """Compile the kernels of ``runs`` that no earlier call has compiled, ``workers`` at a time, with
    progress under ``title`` on standard error.

    Runs with the same model and the same effects count as one. With one worker, or one kernel to
    compile, this does nothing, and the run compiles its own.
    """
    missing: dict[Path, Run] = {}
    for run in runs:
        if not (mark := _mark(run)).is_file():
            missing.setdefault(mark, run)
    if min(workers, len(missing)) < 2:
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
                future.result()
                remember(run)
                board.finished(run.label, "compiled")
    except BrokenProcessPool:
        say("  a process that compiled kernels was ended; the runs compile their own")
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _mark(run: Run, many: bool = False) -> Path:
    """File in the cache of kernels that says that those of ``run`` are there."""
    key = content_hash(
        kernel_digest(f"tipoff.{run.fidelity}"),
        run.model,
        run.scene.absent_effects(),
        _modes(run),
        *(["ensemble"] if many else []),
    )
    return sources.cache_folder() / "kernels" / f"compiled-{key[:16]}"


def _modes(run: Run) -> str | bool:
    """What decides which kernels there are of rails: a number to be chosen, some modes, or none."""
    pressed = run.model == COMPLIANT and run.compliance is not None
    modes = getattr(run.numerics, "modes", 0) if pressed else 0
    return AUTO if modes == AUTO else modes > 0
