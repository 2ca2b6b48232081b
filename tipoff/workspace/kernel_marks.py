"""Marks in the cache of the kernels that runs have compiled, so that a user is told before the
first run that must wait for compilation.

A surrogate run that chooses its modes of the rails begins with kernels without modes. The kernels
with modes are separate: they are compiled only if the run needs them, and have their own mark.
"""

import functools
import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from tipoff import cache, sources
from tipoff.files import content_hash
from tipoff.kernels import called
from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.scenes.scene import Scene
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run

_AGAIN = "its kernels are announced again"
_WITH_MODES = ", and the same time again if modes of the rails are needed"
_RARE = 50_000, 50, 50  # new objects before a collection, and collections of each older generation
_SAID: set[Path] = set()  # marks of kernels that this process has announced
_USED: set[Path] = set()  # marks of kernels that this process has compiled or loaded
_MARKS: cache.Cache[dict] = cache.documents(dict, dict, cache.Held)


@contextmanager
def first_use(run: Run, many: bool = False) -> Iterator[None]:
    """Announce the kernels of ``run``, or of ``many`` cases like it, and mark them after the block
    has used them. A process that has marked them asks no file again."""
    path, _ = mark(run, many=many)
    if path in _USED:
        yield
        return
    announce(run, many=many)
    with rare_collections():
        yield
    remember(run, many=many)
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


@contextmanager
def chosen_modes(run: Run) -> Iterator[Callable[[int], None]]:
    """The argument ``vibrates`` of ``lowfi.run`` for ``run``: it announces the kernels with modes
    when the run has chosen modes. They are marked after the block has used them."""
    chosen: list[int] = []

    def vibrates(modes: int) -> None:
        if not chosen:
            announce(run, chosen=True)
        chosen.append(modes)

    yield vibrates
    if chosen:
        remember(run, chosen=True)


def announce(run: Run, chosen: bool = False, many: bool = False) -> None:
    """Print, once per process, that the kernels of ``run``, or of ``many`` cases like it, must be
    compiled, unless a run has compiled them. ``chosen``: kernels with rail modes, else those with
    which the run begins."""
    path, _ = mark(run, chosen, many)
    if path in _SAID or are_there(run, chosen, many):
        return
    _SAID.add(path)
    vibrates = _vibrates(run, chosen)
    chooses = _modes(run) == AUTO and not chosen
    say(
        f"compiling the kernels of model {run.model}"
        + (" with modes of the rails" if vibrates else "")
        + " for these effects: about 20 s, once"
        + (_WITH_MODES if chooses and not are_there(run, True, many) else "")
    )


def remember(run: Run, chosen: bool = False, many: bool = False) -> None:
    """Mark in the cache that ``run``, or ``many`` cases like it, compiled its kernels. ``chosen``:
    kernels with rail modes."""
    with suppress(OSError):  # they will be announced again
        _MARKS.get_or_make(*mark(run, chosen, many), _AGAIN, dict)


def are_there(run: Run, chosen: bool = False, many: bool = False) -> bool:
    """Whether ``remember`` has marked these kernels."""
    return _MARKS.get(*mark(run, chosen, many), _AGAIN) is not None


def mark(run: Run, chosen: bool = False, many: bool = False) -> tuple[Path, str]:
    """The file of the mark of the kernels of ``run``, or of ``many`` cases like it, and its key."""
    return _mark(
        sources.cache_folder() / "kernels",
        _code(run.fidelity),
        run.model,
        _not_compiled(run.scene),
        _vibrates(run, chosen),
        _degree(run),
        many,
        # many cases that choose their modes need the kernels without and with modes
        many and not chosen and _modes(run) == AUTO,
    )


@functools.cache  # a run of the surrogate asks three times
def _mark(folder: Path, *kernels: Any) -> tuple[Path, str]:
    key = content_hash(*kernels)
    return cache.file(folder, "compiled", key, ".json"), key


@functools.cache
def _code(fidelity: str) -> str:
    """Digest of the code of a time loop."""
    loop: Any
    if fidelity == "highfi":
        from tipoff.highfi.dynamics.step import perform as loop
    else:
        from tipoff.lowfi.dynamics.integrate import integrate as loop
    return called.digest(loop)


def _not_compiled(scene: Scene) -> tuple[str, ...]:
    """Effects without code in the kernels of ``scene``: absent ones, and body forces if a free
    platform falls with the payload (``mechanics.comoving``)."""
    falls = scene.platform is not None
    absent = scene.absent_effects()
    return tuple(
        item.key for item in EFFECTS if item.key in absent or (falls and item.is_body_force)
    )


def _vibrates(run: Run, chosen: bool) -> bool:
    """Whether the run needs the kernels with modes of the rails: it requests or has ``chosen``
    modes."""
    return chosen or _modes(run) not in (AUTO, 0)


def _modes(run: Run) -> str | int:
    """Modes of the rails that ``run`` requests, zero if nothing presses a rail."""
    pressed = run.model == COMPLIANT and run.compliance is not None
    return getattr(run.numerics, "modes", 0) if pressed else 0


def _degree(run: Run) -> int | str | None:
    """Degree of the patterns on a pad face, for which kernels are compiled; ``"auto"`` stands for those
    of a choice. None on rigid walls."""
    if run.model != COMPLIANT or run.compliance is None:
        return None
    return run.numerics.degree or run.compliance.degree
