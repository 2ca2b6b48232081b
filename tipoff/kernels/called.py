"""The code that a kernel calls: a digest of its own, of every kernel below it and of the constants
that they name.

An edit of other code, even in the same file, leaves the digest as it is. Python holds the code of a
function without comments; docstrings are left out here. Types of the arguments are not part of it.
"""

import functools
import hashlib
import inspect
import sys
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from numba.core.dispatcher import Dispatcher

from tipoff import sources

# Modules that make machine code of a kernel: their code counts for each.
_COMPILER = ("tipoff.kernels.jit", "tipoff.kernels.reference")
_PLAIN = (bool, int, float, complex, str, bytes, type(None), np.generic, np.dtype)
_settings: Any = numba.config  # defined at run time, so a type checker does not know it


def digest(*functions: Callable) -> str:
    """Hexadecimal digest (16 digits) of the code that Python ``functions`` or kernels call, of the
    code that compiles it, of the versions of Python and Numba and of the optimisation level."""
    compiler = [sources.source(module).code for module in _COMPILER]
    of_all = (sys.version_info[:2], numba.__version__, _settings.OPT, compiler)
    parts = sorted(map(str, of_functions(*functions).values()))
    return hashlib.sha256("\n".join([repr(of_all), *parts]).encode()).hexdigest()[:16]


def of_functions(*functions: Callable) -> dict[Callable, str]:
    """Text of the own code and constants of ``functions`` and of all functions that they call."""
    found: dict[Callable, str] = {}
    waiting = list(map(_python, functions))
    while waiting:
        function = waiting.pop()
        if function not in found:
            found[function], called = own(function)
            waiting += called
    return found


def _python(function: Any) -> Callable:
    return function.py_func if isinstance(function, Dispatcher) else function


@functools.cache  # kernels share most of the functions that they call
def own(function: FunctionType) -> tuple[str, tuple[Callable, ...]]:
    """Text of the code of one function and of the constants that it names, and the functions that
    it calls."""
    code = function.__code__
    text = [function.__module__, function.__qualname__, *_text(code, function.__doc__)]
    called: dict[Callable, None] = {}
    for name, value in sorted(_named(function, set(_names(code))).items()):
        if isinstance(value, Dispatcher):
            text.append(f"{name} compiled with {sorted(value.targetoptions.items())!r}")
            called[value.py_func] = None
        elif isinstance(plain := inspect.unwrap(value), FunctionType) and _is_ours(plain):
            called[plain] = None  # a function, or that of an intrinsic of Numba
        elif isinstance(value, type) and not hasattr(value, "_fields") and _is_ours(value):
            values, methods = _content(value)
            text.append(f"{name} = {value.__mro__} {values}")
            called |= dict.fromkeys(methods)
        else:
            text.append(f"{name} = {_constant(value)}")
    text.append(repr(function.__defaults__))
    return "\n".join(text), tuple(called)


def _text(code: CodeType, words: str | None) -> Iterator[str]:
    """The instructions and constants of ``code``, without the docstring ``words``."""
    yield code.co_code.hex()
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_argcount))
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _text(constant, None)
        else:
            yield repr(None if constant == words else constant)


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    yield from code.co_freevars
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _named(function: FunctionType, names: set[str]) -> dict[str, Any]:
    """Values of the ``names`` in the variables around ``function``, and in the modules of the
    project among these."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or ())
    around = function.__globals__ | {name: cell.cell_contents for name, cell in cells}
    found: dict[str, Any] = {}
    spaces = [("", around)]
    seen = set()
    while spaces:
        prefix, space = spaces.pop()
        for name in names & space.keys():
            value = space[name]
            if not isinstance(value, ModuleType):
                found[prefix + name] = value
            elif sources.path(value.__name__) and value.__name__ not in seen:
                seen.add(value.__name__)
                spaces.append((f"{prefix}{name}.", vars(value)))
    return found


def _is_ours(value: Any) -> bool:
    return sources.path(value.__module__) is not None


def _content(kind: type) -> tuple[dict[str, Any], list[Callable]]:
    """Plain values and functions of a class and of its bases in the project. Its functions make
    code, and are not compiled."""
    values: dict[str, Any] = {}
    functions: list[Callable] = []
    for base in kind.__mro__:
        for name, value in vars(base).items() if _is_ours(base) else ():
            if isinstance(plain := inspect.unwrap(value), FunctionType):
                functions.append(plain)
            elif isinstance(value, _PLAIN) and not name.startswith("__"):
                values[f"{base.__qualname__}.{name}"] = value
    return values, functions


def _constant(value: Any) -> str:
    """Text of a value that a kernel names. One that has a module of the project, and is no record,
    counts with all code of that module."""
    if isinstance(value, _PLAIN):
        return repr(value)
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    if isinstance(value, (tuple, list)) and not hasattr(value, "_fields"):
        return f"({', '.join(map(_constant, value))})"
    if isinstance(value, type) and hasattr(value, "_fields"):
        return f"{value.__qualname__} {value._fields}"
    module = getattr(value, "__module__", None) or type(value).__module__
    if sources.path(module):
        return sources.digest(module)
    return f"{module}.{getattr(value, '__qualname__', type(value).__qualname__)}"
