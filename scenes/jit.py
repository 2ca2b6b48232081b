"""Numba settings shared by every kernel, and a disk cache that cannot go stale.

Numba keys its cache by the file of the compiled function only: a kernel whose *callee* in another
file changed is loaded from disk with the old callee inside. The cache directory is therefore named
by a digest of all kernel sources, so any edit starts an empty cache.
"""

import functools
import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeVar, overload

import numba

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

_KERNEL_PACKAGES = ("scenes", "highfi", "lowfi")
# Numba names its settings while it loads, where no type checker sees them.
_settings: Any = numba.config
_Function = TypeVar("_Function", bound=Callable[..., object])


class Compiler(Protocol):
    """A decorator that makes a kernel of a function, bare or with options. A kernel is called as
    the function is, and tells of its compilation besides."""

    @overload
    def __call__(self, function: _Function, /) -> "Dispatcher[_Function]": ...
    @overload
    def __call__(self, /, *, inline: Literal["never", "always"]) -> "Compiler": ...


def kernel_digest() -> str:
    """Hexadecimal digest (16 digits) of every source file that may hold a kernel,
    of the Numba version and its optimisation level."""
    root = Path(__file__).resolve().parent.parent
    digest = hashlib.sha256(f"{numba.__version__} {_settings.OPT!r}".encode())
    for package in _KERNEL_PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(str(path.relative_to(root)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_directory() -> Path:
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    default = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "tipoff" / "kernels"
    return (Path(chosen) if chosen else default) / kernel_digest()


# Kernels are compiled as parts of those that call them, each time from code that was optimised
# before. At level 3 the first pass turns vectors of states into scalars, which the next one does
# not mend: the surrogate then takes half as long again.
if "NUMBA_OPT" not in os.environ:
    _settings.OPT = type(_settings.OPT)("max")

_settings.CACHE_DIR = str(_cache_directory())

if TYPE_CHECKING:
    njit: Compiler
    kernel: Compiler
    inlined: Compiler
else:
    # error_model="numpy": division by zero gives inf, which reaches the status check, instead of an
    # exception inside a kernel.
    njit = functools.partial(numba.njit, cache=True, error_model="numpy", nogil=True)
    # For kernels that neither make nor return arrays: without reference counts, which cost more
    # than the arithmetic where records of arrays are handed from function to function, and half the
    # time to compile.
    kernel = functools.partial(njit, _nrt=False)
    # The same for what innermost loops call with whole records: each call would copy some hundred
    # words of array headers.
    inlined = functools.partial(kernel, forceinline=True)


def machine_code(kernel, arguments: tuple) -> bytes:
    """Object code of ``kernel`` for the types of ``arguments``, the very code that runs: what it
    does not name, it cannot call.

    Read from the disk cache, since Numba keeps no copy of code once it is loaded. Raises
    RuntimeError without a cache.
    """
    signature = tuple(numba.typeof(argument) for argument in arguments)
    kernel.compile(signature)
    cache = kernel._cache
    stored = cache._cache_file.load(cache._index_key(signature, kernel.targetctx.codegen()))
    if stored is None:
        raise RuntimeError(f"no compiled {kernel.__name__} in {cache.cache_path}")
    (_, _, (code, _)), *_ = stored
    return code


def contains(code: bytes, function) -> bool:
    """Whether object ``code`` holds the compiled ``function``, called or inlined: Numba leaves one
    symbol for each, in which module and name stand with their lengths, so that no other name can be
    taken for it."""
    python = function.py_func
    parts = (*python.__module__.split("."), *python.__qualname__.split("."))
    return ("NumbaEnv" + "".join(f"{len(part)}{part}" for part in parts) + "B").encode() in code
