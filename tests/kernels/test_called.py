"""The digest of a kernel: all code that it calls, and nothing else."""

import types
from typing import NamedTuple

import numpy as np
import pytest
from numba.extending import intrinsic

from tests.kernels import test_called as this  # a kernel may name a module
from tipoff import sources
from tipoff.highfi.dynamics.step import perform
from tipoff.kernels import called
from tipoff.kernels.jit import entry, kernel
from tipoff.lowfi.dynamics.integrate import integrate
from tipoff.mechanics.laws import friction

FACTOR = 2.0
TABLE = np.array([1.0, 2.0])
LOOPS = pytest.mark.parametrize("loop", [integrate, perform], ids=["surrogate", "reference"])


class Pair(NamedTuple):
    """A record."""

    first: float
    second: float


def constant():
    """A number."""
    return 1.0


@intrinsic
def made(typing, number):
    """Code that a function makes."""
    return number(number), lambda context, builder, signature, arguments: arguments[0]


@kernel
def inner(number):
    """The kernel that others call."""
    return FACTOR * number


@entry
def outer(number):
    """By its name."""
    return inner(number) + TABLE[0]


@entry
def by_module(number):
    """As a member of a module."""
    return this.inner(number)


@entry
def of_record(number):
    """With a record."""
    return Pair(number, number).first


@entry
def of_intrinsic(number):
    """With code that a function makes."""
    return made(number)


@entry
def alone(number):
    """Which calls nothing."""
    return number


ALL = outer, by_module, of_record, of_intrinsic, alone


def changed(monkeypatch, name, value, of=this):
    """The kernels whose digest an exchange of ``name`` changes."""
    before = [called.digest(one) for one in ALL]
    monkeypatch.setattr(of, name, value)
    called.own.cache_clear()
    after = [called.digest(one) for one in ALL]
    return {one.__name__ for one, a, b in zip(ALL, before, after) if a != b}


@pytest.fixture(autouse=True)
def _anew():
    called.own.cache_clear()
    yield
    called.own.cache_clear()


def test_a_constant_of_a_called_kernel_counts(monkeypatch):
    assert changed(monkeypatch, "FACTOR", 3.0) == {"outer", "by_module"}


def test_an_array_counts_by_its_values(monkeypatch):
    assert changed(monkeypatch, "TABLE", TABLE.copy()) == set()
    assert changed(monkeypatch, "TABLE", np.array([1.5, 2.0])) == {"outer"}


def test_a_called_kernel_counts(monkeypatch):
    assert changed(monkeypatch, "inner", kernel(lambda number: number)) == {"outer", "by_module"}


def test_the_options_of_a_called_kernel_count(monkeypatch):
    same = kernel(inner.py_func, forceinline=True)
    assert changed(monkeypatch, "inner", same) == {"outer", "by_module"}


def test_a_record_counts_by_the_places_of_its_members(monkeypatch):
    class Turned(NamedTuple):
        second: float
        first: float

    Turned.__qualname__ = Pair.__qualname__
    assert changed(monkeypatch, "Pair", Turned) == {"of_record"}


def test_the_function_of_an_intrinsic_counts(monkeypatch):
    @intrinsic
    def other(typing, number):
        return number(number), lambda context, builder, signature, arguments: builder.neg(
            arguments[0]
        )

    assert changed(monkeypatch, "made", other) == {"of_intrinsic"}


def test_words_do_not_count():
    function = inner.py_func
    code = function.__code__
    worded = code.replace(
        co_consts=tuple(
            "Other words." if one == function.__doc__ else one for one in code.co_consts
        ),
        co_firstlineno=7,
    )
    other = types.FunctionType(worded, function.__globals__, function.__name__)
    other.__doc__, other.__qualname__ = "Other words.", function.__qualname__
    assert called.digest(other) == called.digest(function)


@LOOPS
def test_the_loops_call_few_modules(loop):
    """None of the tables of scenes. Control: the modules that theirs import are twice as many."""
    modules = {one.__module__ for one in called.of_functions(loop)}
    assert len(modules) <= 45
    assert not [name for name in modules if name.startswith(("tipoff.scenes", "pydantic"))]
    assert len(sources.closure(*modules)) > 2 * len(modules)


@LOOPS
def test_the_law_of_friction_counts_in_both_loops(loop):
    assert friction.coefficient_over_speed.py_func in called.of_functions(loop)
