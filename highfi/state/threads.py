"""Threads that share one run: barrier and work queue.

All threads take the same steps. A step lasts tens of microseconds, so a thread that waits at a
barrier spins first. After about 0.2 ms it sleeps on a condition variable, and the last thread to
arrive wakes it. ``sched_yield`` cannot replace the sleep: beside another busy program, Linux would
delay the thread by a whole time slice at each barrier.
"""

import ctypes
import os
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from tipoff.highfi.extruded.mesh import LANES
from tipoff.kernels.jit import kernel
from tipoff.kernels.memory import zeros
from tipoff.kernels.reference import by_reference

_ROUND, _ARRIVED, _NEXT, _ASLEEP, _MUTEX, _CONDITION = 0, 8, 16, 24, 32, 40  # cache lines
_SPINS = 100_000  # reads of the round before a waiting thread sleeps: about 0.2 ms
_FEWER_SPINS = 4_000  # the same if there are more threads than processors
_WORD = ir.IntType(64)
_POSIX = os.name == "posix"  # on other systems, threads only spin


@by_reference
class Team(NamedTuple):
    """Threads of one run."""

    size: int
    spins: int  # reads of the round before a waiting thread sleeps
    counters: np.ndarray  # (48,) barrier, work queue, mutex, condition variable
    lanes: np.ndarray  # (size, 4, LANES) workspace of each thread; also the forces of one element


def team_of(size: int) -> Team:
    """A team of ``size`` threads."""
    counters = np.zeros(48, dtype=np.int64)
    if _POSIX:
        library = ctypes.CDLL(None)
        for name, place in (("mutex", _MUTEX), ("cond", _CONDITION)):
            begin = getattr(library, f"pthread_{name}_init")
            begin(ctypes.c_void_p(counters[place:].ctypes.data), None)
    spins = _SPINS if size <= processors() else _FEWER_SPINS
    return Team(size=size, spins=spins, counters=counters, lanes=zeros((size, 4, LANES)))


def processors() -> int:
    """Processors this process may use, at most ``OMP_NUM_THREADS``."""
    here = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    most = os.environ.get("OMP_NUM_THREADS", "")
    return min(here, int(most)) if most.isdecimal() and int(most) > 0 else here


def _element(context, builder, signature, arguments):
    data = context.make_array(signature.args[0])(context, builder, value=arguments[0]).data
    return builder.gep(data, [arguments[1]])


@intrinsic
def _add(typing, counters, index, value):
    """counters[index] += value, atomic; returns the value before."""

    def generate(context, builder, signature, arguments):
        place = _element(context, builder, signature, arguments)
        return builder.atomic_rmw("add", place, arguments[2], "seq_cst")

    return types.int64(counters, types.intp, types.int64), generate


@intrinsic
def _read(typing, counters, index):
    """counters[index], atomic; what other threads wrote before it is visible."""

    def generate(context, builder, signature, arguments):
        return builder.load_atomic(_element(context, builder, signature, arguments), "seq_cst", 8)

    return types.int64(counters, types.intp), generate


@intrinsic
def _write(typing, counters, index, value):
    """counters[index] = value, atomic; what was written before is visible with it."""

    def generate(context, builder, signature, arguments):
        builder.store_atomic(
            arguments[2], _element(context, builder, signature, arguments), "seq_cst", 8
        )
        return context.get_dummy_value()

    return types.void(counters, types.intp, types.int64), generate


def _of_threads(name: str, *places: int):
    """A call of ``pthread_name`` with pointers to these ``places`` of the counters; no operation on
    systems without POSIX threads."""

    @intrinsic
    def call(typing, counters):
        def generate(context, builder, signature, arguments):
            if _POSIX:
                pointers = [
                    _element(context, builder, signature, (*arguments, ir.Constant(_WORD, place)))
                    for place in places
                ]
                kind = ir.FunctionType(ir.IntType(32), [item.type for item in pointers])
                function = cgutils.get_or_insert_function(builder.module, kind, f"pthread_{name}")
                builder.call(function, pointers)
            return context.get_dummy_value()

        return types.void(counters), generate

    return call


_lock = _of_threads("mutex_lock", _MUTEX)
_unlock = _of_threads("mutex_unlock", _MUTEX)
_sleep = _of_threads("cond_wait", _CONDITION, _MUTEX)
_wake_all = _of_threads("cond_broadcast", _CONDITION)


@kernel
def barrier(team):
    """Wait until all threads of the team are here.

    No wake-up is lost. A thread counts itself as asleep and then reads the round once more. The
    last thread ends the round and then reads this count. So at least one of the two sees the
    other's value.
    """
    if team.size > 1:
        counters = team.counters
        now = _read(counters, _ROUND)
        if _add(counters, _ARRIVED, 1) == team.size - 1:
            _write(counters, _ARRIVED, 0)
            _write(counters, _ROUND, now + 1)
            if _read(counters, _ASLEEP) > 0:
                _lock(counters)
                _wake_all(counters)
                _unlock(counters)
        spins = 0
        while _read(counters, _ROUND) == now and spins < team.spins:
            spins += 1
        if spins == team.spins:
            _lock(counters)
            _add(counters, _ASLEEP, 1)
            while _read(counters, _ROUND) == now:
                _sleep(counters)
            _add(counters, _ASLEEP, -1)
            _unlock(counters)


@kernel
def reset_queue(team):
    """Restart the numbers of the pieces of work from zero. One thread calls this; a barrier must
    follow before any thread takes a piece."""
    _write(team.counters, _NEXT, 0)


@kernel
def take(team):
    """Number of the next free piece of work."""
    return _add(team.counters, _NEXT, 1)
