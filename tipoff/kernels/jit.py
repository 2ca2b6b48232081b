"""Decorators that make compiled kernels of functions."""

import functools
from collections.abc import Callable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeVar, overload

import numba
from llvmlite.binding import Linkage
from numba.core import sigutils, typed_passes, types, untyped_passes
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, Flags
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager
from numba.core.registry import CPUDispatcher

from tipoff import sources
from tipoff.kernels.cached import KernelCache

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

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


class _PartLibrary(JITCodeLibrary):
    """LLVM code of a kernel that only kernels call. It is not optimised, and has no machine code.

    Numba would do both for every kernel below the one that Python calls: 245 s and 1250 MB instead
    of 100 s and 610 MB for the loops of the surrogate, 79 s instead of 49 s for the loop of finite
    elements.
    """

    def _optimize_functions(self, module) -> None:
        """Simplify the functions that ``module`` defines, so that there is less to link."""
        module.data_layout = self._codegen._data_layout
        passes, options = self._codegen._function_pass_manager(opt=1)
        for function in module.functions:
            if not function.is_declaration:
                passes.run(function, options)

    def finalize(self) -> None:
        """The kernel that Python calls links and optimises the code."""
        self._finalized = True

    def _get_module_for_linking(self):
        """The code with all code that it calls, each part once."""
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            # all parts first, because LLVM drops a definition that nothing calls yet
            libraries = sorted(self._called(), key=lambda one: not isinstance(one, _PartLibrary))
            for library in libraries:
                part = isinstance(library, _PartLibrary)
                code = library._final_module if part else library._get_module_for_linking()
                self._shared_module.link_in(code, preserve=True)
            for function in self._shared_module.functions:
                if not function.is_declaration and function.linkage == Linkage.external:
                    # as Numba does, because other libraries link it too
                    function.linkage = "linkonce_odr"
        return self._shared_module

    def _called(self) -> list[JITCodeLibrary]:
        """Libraries of all functions that the code calls, directly or not."""
        found: dict[JITCodeLibrary, None] = {}
        waiting = list(self._linking_libraries)
        while waiting:
            library = waiting.pop()
            if library not in found and library is not self:
                found[library] = None
                waiting += library._linking_libraries if isinstance(library, _PartLibrary) else ()
        return list(found)

    def get_pointer_to_function(self, name: str) -> int:
        """Zero: there is no machine code."""
        return 0

    @property
    def codegen(self):
        """Code generator. Without machine code there is no place for the environment of the
        function."""
        return SimpleNamespace(set_env=lambda name, environment: None)


class _EntryLibrary(JITCodeLibrary):
    """Machine code of a kernel that Python calls, with all kernels that it calls. The called
    kernels are private, so LLVM can inline them and change their arguments: 4.7 ms instead of 5.9
    ms for a run of the surrogate. A private function has no symbol. The loader resolves symbols by
    name in all machine code of a process, so a symbol could replace a function with other
    arguments."""

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if function.linkage == Linkage.linkonce_odr:
                function.linkage = "private"
        # Numba would optimise twice, first to remove reference counts, then at level 3
        passes, options = self._codegen._module_pass_manager(opt=2)
        passes.run(self._final_module, options)


class Options(Flags):
    """Numba's options of a compilation, with a quick comparison: each call in a kernel makes
    several. Those of Numba compare all defaults too, a seventh of the time to compile."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Options) and self._values == other._values

    def __hash__(self) -> int:
        return hash(frozenset(self._values))


# Numba's passes that a kernel needs, in Numba's order. It has no closures, generators, array expressions and
# reference counts, and each pass takes a hundredth of the time to compile or more.
_PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    untyped_passes.DeadBranchPrune,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)


class _PartCompiler(Compiler):
    """Numba's compiler with the library and the passes that are set here."""

    library: type[JITCodeLibrary] = _PartLibrary

    def __init__(self, typing, target, library, arguments, returned, flags, local):
        super().__init__(typing, target, library, arguments, returned, Options(flags), local)

    def define_pipelines(self) -> list:
        """The passes of a kernel."""
        state = self.state
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        manager = PassManager("kernel")
        for each in _PASSES:
            manager.add_pass(each, each.__name__)
        manager.finalize()
        return [manager]


class _EntryCompiler(_PartCompiler):
    """The same for a kernel that Python calls."""

    library = _EntryLibrary


class _Part(CPUDispatcher):
    """A kernel that only kernels call. A call from Python, as in a test, compiles a caller for it."""

    def __init__(self, function: Callable, **options: Any):
        flags = {"nopython": True, "no_cpython_wrapper": True}
        super().__init__(
            function,
            targetoptions=_OPTIONS | _ARRAYS | flags | options,
            pipeline_class=_PartCompiler,
        )

    def get_call_template(self, arguments, named):
        """Numba's. A constant counts as any value of its type: else each has code of its own."""
        plain = tuple(map(types.unliteral, arguments))
        return super().get_call_template(
            plain, {name: types.unliteral(each) for name, each in named.items()}
        )

    @global_compiler_lock
    def compile(self, signature):
        """Numba's, without its timers. Each call of LLVM would stop those of all kernels above, too."""
        arguments, returned = sigutils.normalize_signature(signature)
        if arguments not in self.overloads:
            with self._compiling_counter:
                self.add_overload(self._compiler.compile(arguments, returned))
        return self.overloads[arguments].entry_point

    def __call__(self, *arguments):
        if not hasattr(self, "_caller"):
            self._caller = _caller(self)
        return self._caller(*arguments)


def _caller(part: _Part) -> Callable:
    """The caller of a ``part`` for Python; on disk it is a function of the same module."""

    def call(*arguments):
        return part(*arguments)

    call.__module__ = part.py_func.__module__
    call.__qualname__ = f"{part.py_func.__qualname__}_from_python"
    return _njit(call)


def _njit(function: Callable | None = None, **options: Any) -> Callable:
    """``numba.njit`` with our settings and our cache."""
    if function is None:
        return functools.partial(_njit, **options)
    made: Any = numba.njit(function, **_OPTIONS | options)
    # an inner function has other variables of the outer one in each call
    of_module = "<locals>" not in function.__qualname__
    if of_module and sources.path(function.__module__) is not None:
        made._cache = KernelCache(function)
    return made


# error_model="numpy": division by zero gives inf, which reaches the status check, instead of an
# exception inside a kernel.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
_ARRAYS: dict[str, Any] = {"_nrt": False}

if TYPE_CHECKING:
    njit: Decorator
    entry: Decorator
    kernel: Decorator
    inlined: Decorator
else:
    njit = _njit
    # For kernels that neither make nor return arrays: no reference counts. With records of arrays
    # as arguments, these cost more than the arithmetic, and half the time to compile. ``entry`` is
    # for kernels that Python calls, ``kernel`` for all others.
    entry = functools.partial(_njit, pipeline_class=_EntryCompiler, **_ARRAYS)
    kernel = _Part
    # The same for functions in the loops of finite elements, which LLVM would not always inline: 5
    # % of their time.
    inlined = functools.partial(_Part, forceinline=True)
