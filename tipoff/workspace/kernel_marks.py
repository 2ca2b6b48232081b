"""Marks in the cache of the kernels that runs have compiled, so that a user is told before the
first run that must wait for compilation.

There are few kernels, because they skip the effects that a scene does not have. The reference has one
for each kind of elements. The surrogate has one for each kind of contact, degree of the patterns, and
walls of springs (straight or not).
"""

import functools
import gc
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from tipoff import cache, sources
from tipoff.files import content_hash
from tipoff.kernels import cached, called
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.scenes.rail import ProfileTable, SectionTable
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run

_AGAIN = "its kernels are announced again"
_RARE = 50_000, 50, 50  # new objects before a collection, and collections of each older generation
_SAID: set[Path] = set()  # marks of kernels that this process has announced
_USED: set[Path] = set()  # marks of kernels that this process has compiled or loaded
_MARKS: cache.Cache[dict] = cache.documents(dict, dict, cache.Held)


@contextmanager
def first_use(run: Run) -> Iterator[None]:
    """Announce the kernels of ``run``, and mark them after the block has used them. A process that
    has marked them asks no file again."""
    path, _ = mark(run)
    if path in _USED:
        yield
        return
    announce(run)
    with rare_collections():
        yield
    remember(run)
    _USED.add(path)


@contextmanager
def rare_collections() -> Iterator[None]:
    """Context in which Python seldom looks for garbage. Numba makes millions of objects while it
    compiles, and few of them are garbage in cycles: compilation takes 9 % less time, in the same
    memory."""
    before = gc.get_threshold()
    gc.set_threshold(*map(max, before, _RARE))
    try:
        yield
    finally:
        gc.set_threshold(*before)


def announce(run: Run) -> None:
    """Print, once per process, that the kernels of ``run`` must be compiled, unless a run has
    compiled them."""
    path, _ = mark(run)
    if path in _SAID or are_there(run):
        return
    _SAID.add(path)
    say(f"compiling the kernels of model {run.model}: about half a minute, once")


def remember(run: Run) -> None:
    """Mark in the cache that ``run`` compiled its kernels."""
    with suppress(OSError):  # they will be announced again
        _MARKS.get_or_make(*mark(run), _AGAIN, dict)


def are_there(run: Run) -> bool:
    """Whether the package has these kernels, or ``remember`` has marked them."""
    return cached.is_made(_loop(run.fidelity)) or _MARKS.get(*mark(run), _AGAIN) is not None


def mark(run: Run) -> tuple[Path, str]:
    """The file of the mark of the kernels of ``run``, and its key."""
    folder, code = sources.cache_folder() / "kernels", _code(run.fidelity)
    if run.fidelity == "highfi":
        return _mark(folder, code, _elements(run.scene.rail))
    return _mark(folder, code, _degree(run), _is_at_offset_walls(run))


@functools.cache  # a run of the surrogate asks three times
def _mark(folder: Path, *kernels: Any) -> tuple[Path, str]:
    key = content_hash(*kernels)
    return cache.file(folder, "compiled", key, ".json"), key


@functools.cache
def _code(fidelity: str) -> str:
    """Digest of the code of a time loop."""
    return called.digest(_loop(fidelity))


def _loop(fidelity: str) -> Any:
    if fidelity == "highfi":
        from tipoff.highfi.dynamics.step import perform as loop
    else:
        from tipoff.lowfi.dynamics.integrate import integrate as loop
    return loop


def _elements(rail: Any) -> str:
    """The kind of elements of a rail: all sections are extruded."""
    return "extruded" if isinstance(rail, SectionTable | ProfileTable) else type(rail).__name__


def _is_at_offset_walls(run: Run) -> bool:
    """Whether contact springs are at walls that are warm or not straight as drawn."""
    if run.model == COMPLIANT or run.compliance is None:
        return False
    return run.scene.thermal is not None or run.compliance.drawn is not None


def _degree(run: Run) -> int | str | None:
    """Degree of the patterns on a pad face, for which kernels are compiled; ``"auto"`` stands for those
    of a choice. None on rigid walls."""
    if run.model != COMPLIANT or run.compliance is None:
        return None
    return run.numerics.degree or run.compliance.degree
