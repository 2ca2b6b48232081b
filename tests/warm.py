"""Compiles the time loops that several test files share, each once, on all cores.

    python -m tests.warm

Workers of pytest that meet the same kernel at the same time would each compile it. An empty file
beside the kernels says that all loops of this code are compiled: then nothing is done.
"""

from concurrent.futures import ProcessPoolExecutor
from importlib import import_module, metadata
from multiprocessing import get_context
from pathlib import Path

from tipoff import sources

LOOPS = "tests.loops"  # takes seconds to load


def stamp() -> Path:
    """The file that is there once the loops of the present code are compiled."""
    name = f"loops-{metadata.version('numba')}-{sources.digest(LOOPS)[:16]}"
    return sources.cache_folder() / "kernels" / name


def main() -> None:
    """Compile what is not compiled yet."""
    if stamp().exists():
        return
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for done in [pool.submit(loop) for loop in import_module(LOOPS).LOOPS]:
            done.result()
    stamp().touch()


if __name__ == "__main__":
    main()
