"""Numba settings shared by every kernel, and a disk cache that cannot go stale.

Numba keys its cache by the file of the compiled function: a kernel whose *callee* in another file
changed is loaded from disk with the old callee inside, and an edited docstring compiles all kernels
of its file again. Here the compiled kernels of a module lie in a folder that is named by the digest
of the code that the module depends on (``sources``).
"""

import functools
import gc
import hashlib
from collections.abc import Callable
from types import CodeType, FunctionType, SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeVar, overload

import numba
from llvmlite.binding import Linkage
from numba.core import caching
from numba.core.caching import _CacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher

from tipoff import sources
from tipoff.kernels.cached import KernelFiles

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

# Numba names its settings while it loads, where no type checker sees them.
_settings: Any = numba.config
_Function = TypeVar("_Function", bound=Callable[..., object])


class Decorator(Protocol):
    """A decorator that makes a kernel of a function, bare or with options. A kernel is called like
    the function and has the attributes of a Numba dispatcher."""

    @overload
    def __call__(self, function: _Function, /) -> "Dispatcher[_Function]": ...
    @overload
    def __call__(self, /, *, inline: Literal["always"]) -> "Decorator": ...
    @overload
    def __call__(self, /, *, forceinline: bool) -> "Decorator": ...


def kernel_digest(module: str) -> str:
    """Hexadecimal digest (16 digits) of the code that the kernels of a ``module`` (dotted name)
    depend on, of the Numba version and its optimisation level."""
    settings = f"{numba.__version__} {_settings.OPT!r} {sources.digest(module)}"
    return hashlib.sha256(settings.encode()).hexdigest()[:16]


class KernelCacheLocator(_CacheLocator):
    """Where Numba stores the compiled kernels of a module, and how it distinguishes them."""

    def __init__(self, function: FunctionType):
        self._digest = kernel_digest(function.__module__)
        self._place = sources.cache_folder() / "kernels" / f"{function.__module__}-{self._digest}"
        self._code = _digest_of_code(function.__code__)

    @classmethod
    def from_function(cls, py_func: FunctionType, py_file: str) -> "KernelCacheLocator | None":
        """The place of a kernel of this project, None for any other function."""
        if sources.path(py_func.__module__) is None:
            return None
        locator = cls(py_func)
        try:
            locator.ensure_cache_path()
        except OSError as error:
            why = f"{error.strerror}, so compiled kernels cannot be kept; set NUMBA_CACHE_DIR"
            raise OSError(error.errno, why, locator.get_cache_path()) from error
        return locator

    def get_cache_path(self) -> str:
        """Folder of the module's kernels."""
        return str(self._place)

    def get_source_stamp(self) -> str:
        """Digest of the code that a stored kernel must come from."""
        return self._digest

    def get_disambiguator(self) -> str:
        """Distinguishes functions of one name in one module."""
        return self._code


def _digest_of_code(code: CodeType) -> str:
    """Hexadecimal digest (8 digits) of ``code`` without its line numbers and docstring."""
    constants = [
        _digest_of_code(item) if isinstance(item, CodeType) else repr(item)
        for item in code.co_consts[1:]  # the first one is the docstring, or None
    ]
    parts = (code.co_code, code.co_names, code.co_varnames, code.co_freevars, constants)
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:8]


_settings.CACHE_LOCATOR_CLASSES = f"{__name__}.KernelCacheLocator,UserProvidedCacheLocator"
# The class by which Numba's caches reach their files; it has no setting for it.
caching.IndexDataCacheFile = KernelFiles  # type: ignore[misc]
_settings.CACHE_DIR = str(sources.cache_folder() / "kernels")


class _PartLibrary(JITCodeLibrary):
    """LLVM code of a kernel that only kernels call, neither linked nor made machine code."""

    def _optimize_functions(self, module) -> None:
        _simplify(self._codegen, module)

    def finalize(self) -> None:
        """Note what the code needs; the kernel that Python calls links it."""
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self):
        """The code with all that it calls, for a function that Numba links in its own way."""
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            _link(self._shared_module, self._linking_libraries)
            for function in self._shared_module.functions:
                if not function.is_declaration and function.linkage == Linkage.external:
                    function.linkage = "linkonce_odr"
        return self._shared_module

    def get_pointer_to_function(self, name: str) -> int:
        """Zero: there is no machine code."""
        return 0

    @property
    def codegen(self):
        """Code generator for those that ask for one: without machine code there is no place for
        the environment of the function."""
        return SimpleNamespace(set_env=lambda name, environment: None)


class _EntryLibrary(JITCodeLibrary):
    """Machine code of a kernel that Python calls, with all kernels that it calls.

    Each of these is linked once. Numba would link it into each caller, and that into each of its own
    callers. It would also optimise the whole twice, the first time to remove reference counts, which
    kernels do not have.
    """

    def _optimize_functions(self, module) -> None:
        _simplify(self._codegen, module)

    def finalize(self) -> None:
        """Link, optimise, and make the machine code."""
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        _link(self._final_module, self._linking_libraries)
        self._linking_libraries = []
        super().finalize()

    def _optimize_final_module(self) -> None:
        # level 3 takes a tenth more time to compile, and the result is not faster
        passes, options = self._codegen._module_pass_manager(opt=2)
        passes.run(self._final_module, options)


def _simplify(codegen, module) -> None:
    """Run light passes over each function of a ``module`` of LLVM: what is left for the passes over
    the whole is a fraction of the code."""
    module.data_layout = codegen._data_layout
    for function in module.functions:
        passes, options = codegen._function_pass_manager(opt=1)
        passes.run(function, options)


def _link(module, libraries: list) -> None:
    """Link ``libraries`` and all that they call into a ``module`` of LLVM, each once. They become
    private to the module. So LLVM may drop them and change their arguments, and they have no symbol
    in the machine code: the loader resolves symbols by name across all machine code of a process,
    and would call them in the place of functions with the same name and other arguments."""
    own = {function.name for function in module.functions if not function.is_declaration}
    linked: dict[JITCodeLibrary, None] = {}
    while libraries:
        new = dict.fromkeys(library for library in libraries if library not in linked)
        parts = [library for library in new if isinstance(library, _PartLibrary)]
        # at first as they are: a definition that nothing calls yet would be left out otherwise
        for part in parts:
            module.link_in(part._final_module, preserve=True)
        linked |= new
        libraries = [other for part in parts for other in part._linking_libraries]
    for library in linked:
        if not isinstance(library, _PartLibrary):
            module.link_in(library._get_module_for_linking(), preserve=True)
    for function in module.functions:
        if not function.is_declaration and function.name not in own:
            function.linkage = "private"


class _PartCompiler(Compiler):
    """Numba's compiler with libraries of parts."""

    library: type[JITCodeLibrary] = _PartLibrary

    def define_pipelines(self) -> list:
        """Numba's passes, which lower to the library that is set here."""
        state = self.state
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        return super().define_pipelines()


class _EntryCompiler(_PartCompiler):
    """The same with libraries of what Python calls."""

    library = _EntryLibrary

    def define_pipelines(self) -> list:
        """The same, with machine code that the cache can keep."""
        pipelines = super().define_pipelines()
        self.state.library.enable_object_caching()
        return pipelines


class _Part(CPUDispatcher):
    """A kernel that only kernels call.

    LLVM sees its code once, inside the kernel that Python calls. Numba alone would optimise it and
    make machine code for every caller on the way, with wrappers that unpack all arrays of the
    records: two thirds of the time to compile, and the result was slower. A call from Python, as in
    a test, compiles a caller.
    """

    def __init__(self, function: Callable, **options: Any):
        flags = {"nopython": True, "_nrt": False, "no_cpython_wrapper": True}
        super().__init__(
            function, targetoptions=_OPTIONS | flags | options, pipeline_class=_PartCompiler
        )

    def __call__(self, *arguments):
        if not hasattr(self, "_caller"):
            self._caller = _caller(self)
        return self._caller(*arguments)


def _call(*arguments):
    return part(*arguments)  # noqa: F821


def _caller(kernel: _Part) -> Callable:
    """What Python calls in the place of ``kernel``: ``_call``, kept on disk as a function of the
    module of the kernel, which is the global ``part``. Numba finds no stored function with a
    closure."""
    function = kernel.py_func
    names = {"__name__": function.__module__, "part": kernel}
    made = FunctionType(_call.__code__, names, f"{function.__name__}_from_python")
    made.__qualname__ = f"{function.__qualname__}_from_python"
    kept = sources.path(function.__module__) is not None
    return numba.njit(made, cache=kept, **_OPTIONS)


_RARELY = 1_000_000  # objects


class _Entry(CPUDispatcher):
    """A kernel that Python calls, with all kernels that it calls."""

    def __init__(self, function: Callable, **options: Any):
        flags = {"nopython": True, "_nrt": False}
        super().__init__(
            function, targetoptions=_OPTIONS | flags | options, pipeline_class=_EntryCompiler
        )
        self.enable_caching()

    def compile(self, signature):
        """Compile for ``signature``. Numba makes millions of objects that live until it is done: a
        seventh of its time would go into looking for unused ones."""
        with global_compiler_lock:  # threads that compile together would not restore the threshold
            threshold = gc.get_threshold()
            gc.set_threshold(_RARELY, *threshold[1:])
            try:
                return super().compile(signature)
            finally:
                gc.set_threshold(*threshold)


def _entry(function: Callable | None = None, **options: Any) -> Callable:
    """The decorator that makes an ``_Entry``, bare or with options."""
    return functools.partial(_Entry, **options) if function is None else _Entry(function, **options)


# error_model="numpy": division by zero gives inf, which reaches the status check, instead of an
# exception inside a kernel.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}

if TYPE_CHECKING:
    njit: Decorator
    entry: Decorator
    kernel: Decorator
    inlined: Decorator
else:
    njit = functools.partial(numba.njit, cache=True, **_OPTIONS)
    # For kernels that neither make nor return arrays: without reference counts, which cost more
    # than the arithmetic where records of arrays are handed from function to function, and half the
    # time to compile. ``entry`` is for those that Python calls, ``kernel`` for all others.
    entry = _entry
    kernel = _Part
    # The same for what the loops of finite elements call, which LLVM would not always inline: 5 %
    # of their time.
    inlined = functools.partial(_Part, forceinline=True)


def machine_code(kernel, arguments: tuple) -> bytes:
    """Object code of ``kernel`` for the types of ``arguments``: the code that runs.

    It is read from the disk cache, since Numba keeps no copy of loaded code. Raises RuntimeError
    without a cache.
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
    """Whether object ``code`` holds the compiled ``function``, called or inlined. Numba leaves one
    symbol for each function, with the lengths of its module and name, so that the match is
    exact."""
    python = function.py_func
    parts = (*python.__module__.split("."), *python.__qualname__.split("."))
    return ("NumbaEnv" + "".join(f"{len(part)}{part}" for part in parts) + "B").encode() in code
