"""Compiled kernels on disk: a file for each kernel and combination of types.

This takes the place of ``numba.njit(cache=True)``, which keeps wrong code (Numba 0.68):

- Its cache notices an edit of the file of a kernel, but not of other files that the kernel calls.
  Here the name of a folder is the digest of all code that a module depends on (``sources``).
- It numbers the files of a kernel in an index, and parallel processes overwrite the index. In a
  trial, processes compiled one function at the same time for different types: 3 of 80 later calls
  ran the code of other types, 11 compiled again. Here the name of a file follows from the types.
- It runs a file with a damaged byte. Here such a file counts as missing.
- A full disk ends the program. Here the kernel is not kept.
"""

import contextlib
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba import cloudpickle
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from tipoff import sources
from tipoff.cache import Cache, binary

# Numba defines its settings at run time, so a type checker does not know them.
_settings: Any = numba.config
# Numba's own format is a pickle.
_FILES: Cache[tuple] = binary(dumps, lambda path: cloudpickle.loads(path.read_bytes()))


def kernel_digest(module: str) -> str:
    """Hexadecimal digest (16 digits) of the code that the kernels of a ``module`` (dotted name)
    depend on, of the Numba version and its optimisation level."""
    settings = f"{numba.__version__} {_settings.OPT!r} {sources.digest(module)}"
    return hashlib.sha256(settings.encode()).hexdigest()[:16]


class KernelCache:
    """The compiled code of one ``function`` of a module of the project, with the interface of a
    cache of Numba's dispatcher."""

    def __init__(self, function: Callable):
        module = function.__module__
        self._folder = _folder() / f"{module}-{kernel_digest(module)}"
        self._name = f"{module.rpartition('.')[2]}.{function.__qualname__}"

    @property
    def cache_path(self) -> str:
        """Folder of the files."""
        return str(self._folder)

    def stored(self, types: tuple, codegen: Any) -> Any:
        """The data from which Numba rebuilds the code for arguments of ``types``, or None."""
        key = _key(types, codegen)
        found = _FILES.get(*self._place(key), "the kernel is compiled again")
        # different types can have the same name
        return found[1] if found is not None and found[0] == key else None

    def load_overload(self, types: tuple, context: Any) -> Any:
        """The code for ``types``, ready to run in this process, or None."""
        context.refresh()  # Numba defines its own functions at first use
        code = self.stored(types, context.codegen())
        return None if code is None else CompileResult._rebuild(context, *code)

    def save_overload(self, types: tuple, compiled: Any) -> None:
        """Keep ``compiled`` code, unless it contains an address of this process or the disk is
        full."""
        if compiled.library.has_dynamic_globals:
            return
        key = _key(types, compiled.codegen)
        with contextlib.suppress(OSError):
            _FILES.put(*self._place(key), (key, compiled._reduce()))

    def _place(self, key: tuple) -> tuple[Path, str]:
        """The file, and its digest."""
        digest = hashlib.sha256(repr(key).encode()).hexdigest()
        return self._folder / f"{self._name}-{digest[:16]}.nbc", digest


def _key(types: tuple, codegen: Any) -> tuple:
    """Types of the arguments, kind of processor."""
    return tuple(types), codegen.magic_tuple()


def _folder() -> Path:
    """Folder of all kernels. Raises OSError where it cannot be made."""
    folder = sources.cache_folder() / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        why = f"{error.strerror}, so compiled kernels cannot be kept; set NUMBA_CACHE_DIR"
        raise OSError(error.errno, why, str(folder)) from error
    return folder
