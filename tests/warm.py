"""Compile the time loops that several test files share, each once.

    python -m tests.warm

Workers of pytest that meet the same kernel at the same time would each compile it. An empty file
beside the kernels says that all loops of this code are compiled: then nothing is done.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

from tipoff import sources
from tipoff.highfi.dynamics.step import perform
from tipoff.kernels import called
from tipoff.lowfi.dynamics.integrate import integrate

LOOPS = "tests.loops"  # takes seconds to load


def stamp() -> Path:
    """The file that is there once the loops of the present code are compiled."""
    name = f"loops-{called.digest(perform, integrate)}-{sources.source(LOOPS).code[:16]}"
    return sources.cache_folder() / "kernels" / name


def run(loops: Sequence[Callable[[], None]]) -> None:
    """Run one loop after the other."""
    for loop in loops:
        loop()


def main() -> None:
    """Compile the loops that are not compiled yet. On few cores, one process compiles a family, whose
    loops share code; on many, each loop has its own."""
    if stamp().exists():
        return
    families = import_module(LOOPS).FAMILIES
    loops = [(loop,) for family in families for loop in family]
    shares = families if (os.cpu_count() or 1) <= 2 * len(families) else loops
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for done in [pool.submit(run, share) for share in shares]:
            done.result()
    stamp().touch()


if __name__ == "__main__":
    main()
