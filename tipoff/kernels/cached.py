"""Compiled kernels on disk: a file for each kernel and combination of types.

This takes the place of ``numba.njit(cache=True)``, which keeps wrong code (Numba 0.68):

- Its cache notices an edit of the file of a kernel, but not of other files that the kernel calls.
  Here the name of a folder has the digest of all code that the kernel calls (``called``).
- It numbers the files of a kernel in an index, and parallel processes overwrite the index. In a
  trial, processes compiled one function at the same time for different types: 3 of 80 later calls
  ran the code of other types, 11 compiled again. Here the name of a file follows from the types.
- It runs a file with a damaged byte. Here such a file counts as missing.
- A full disk ends the program. Here the kernel is not kept.

A wheel of `make wheel` has the kernels of all time loops, compiled for processors of the level
x86-64-v3 (2013 and later). They are used where the cache of the user has none.
"""

import contextlib
import functools
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from llvmlite import binding
from numba import cloudpickle, types
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from tipoff import sources
from tipoff.cache import Cache, binary
from tipoff.kernels import called

# Numba's own format is a pickle.
_FILES: Cache[tuple] = binary(dumps, lambda path: cloudpickle.loads(path.read_bytes()))
# Kernels in a wheel, and the name of their kind of processor with the features that it must have.
MADE = Path(__file__).parent / "made"
LEVEL = "x86-64-v3"
FEATURES = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")


class KernelCache:
    """The compiled code of one ``function`` of a module of the project, with the interface of a
    cache of Numba's dispatcher."""

    def __init__(self, function: Callable):
        self._function = function
        self._name = f"{function.__module__.rpartition('.')[2]}.{function.__qualname__}"

    @property
    def cache_path(self) -> str:
        """Folder of the files."""
        return str(self._folder)

    @functools.cached_property
    def _folder(self) -> Path:
        # at first use, when the modules of all called kernels are loaded
        return _folder() / folder_name(self._function)

    def stored(self, arguments: tuple, codegen: Any) -> Any:
        """The data from which Numba rebuilds the code for these types of ``arguments``, or None."""
        places = [(self._folder, _key(arguments, codegen))]
        if is_made_for_this_processor() and (MADE / self._folder.name).is_dir():
            places.append((MADE / self._folder.name, _key(arguments, codegen, LEVEL)))
        for folder, key in places:
            found = _FILES.get(*self._place(folder, key), "the kernel is compiled again")
            # different types can have the same name
            if found is not None and found[0] == key:
                return found[1]
        return None

    def load_overload(self, arguments: tuple, context: Any) -> Any:
        """The code for these types of ``arguments``, ready to run in this process, or None."""
        context.refresh()  # Numba defines its own functions at first use
        code = self.stored(arguments, context.codegen())
        return None if code is None else CompileResult._rebuild(context, *code)

    def save_overload(self, arguments: tuple, compiled: Any) -> None:
        """Keep ``compiled`` code, unless it contains an address of this process or the disk is
        full."""
        if compiled.library.has_dynamic_globals:
            return
        key = _key(arguments, compiled.codegen)
        with contextlib.suppress(OSError):
            _FILES.put(*self._place(self._folder, key), (key, compiled._reduce()))

    def _place(self, folder: Path, key: tuple) -> tuple[Path, str]:
        """The file in a ``folder``, and its digest."""
        digest = hashlib.sha256(repr(key).encode()).hexdigest()
        return folder / f"{self._name}-{digest[:16]}.nbc", digest


@functools.cache
def is_made_for_this_processor() -> bool:
    """Whether the package has compiled kernels that this processor can run."""
    return MADE.is_dir() and all(map(binding.get_host_cpu_features().get, FEATURES))


def is_made(function: Callable) -> bool:
    """Whether the package has kernels of the present code of ``function`` for this processor."""
    return is_made_for_this_processor() and (MADE / folder_name(function)).is_dir()


def folder_name(function: Callable) -> str:
    """Name of the folder of all kernels of a ``function``."""
    return f"{function.__module__}-{called.digest(function)}"


def _key(arguments: tuple, codegen: Any, level: str | None = None) -> tuple:
    """Types of the arguments, names of the members of records among them, kind of processor: that of
    the code generator, or a ``level``."""
    system, *processor = codegen.magic_tuple()
    kind = (system, level, "") if level else (system, *processor)
    return tuple(arguments), tuple(map(_members, arguments)), kind


def _members(kind: Any) -> tuple:
    """Names of the members of a type, and of theirs. Numba's name of a record does not have them, and
    a kernel finds a member by its place."""
    if not isinstance(kind, (types.NamedTuple, types.NamedUniTuple)):
        return ()
    return kind.fields, tuple(map(_members, kind.types))


def _folder() -> Path:
    """Folder of all kernels. Raises OSError where it cannot be made."""
    folder = sources.cache_folder() / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        why = f"{error.strerror}, so compiled kernels cannot be kept; set NUMBA_CACHE_DIR"
        raise OSError(error.errno, why, str(folder)) from error
    return folder
