"""Threads that share one run: barrier and work queue.

All threads take the same steps. The barrier spins, because a step lasts tens of microseconds; a
thread that waits for long yields its processor.
"""

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

_ROUND, _ARRIVED, _NEXT = 0, 8, 16  # a cache line apart
_SPINS = 4000  # before a waiting thread yields its processor


class Team(NamedTuple):
    """Threads of one run."""

    size: int
    counters: np.ndarray  # of the barrier and of the work queue
    lanes: np.ndarray  # (size, 4, LANES) workspace of each thread; also the forces of one element


def team_of(size: int) -> Team:
    """A team of ``size`` threads."""
    return Team(size=size, counters=np.zeros(24, dtype=np.int64), lanes=zeros((size, 4, LANES)))


def processors() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _element(context, builder, signature, arguments):
    data = context.make_array(signature.args[0])(context, builder, value=arguments[0]).data
    return builder.gep(data, [arguments[1]])


@intrinsic
def _add_one(typing, counters, index):
    """counters[index] += 1, atomic; returns the value before."""

    def generate(context, builder, signature, arguments):
        place = _element(context, builder, signature, arguments)
        return builder.atomic_rmw("add", place, ir.Constant(ir.IntType(64), 1), "seq_cst")

    return types.int64(counters, types.intp), generate


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


@intrinsic
def _yield_processor(typing):
    """Let other threads run, where the system has a call for it."""

    def generate(context, builder, signature, arguments):
        if os.name == "posix":
            builder.call(
                cgutils.get_or_insert_function(
                    builder.module, ir.FunctionType(ir.IntType(32), []), "sched_yield"
                ),
                [],
            )
        return context.get_dummy_value()

    return types.void(), generate


@kernel
def barrier(team):
    """Wait until every thread of the team is here."""
    if team.size > 1:
        counters = team.counters
        now = _read(counters, _ROUND)
        if _add_one(counters, _ARRIVED) == team.size - 1:
            _write(counters, _ARRIVED, 0)
            _write(counters, _ROUND, now + 1)
        spins = 0
        while _read(counters, _ROUND) == now:
            spins += 1
            if spins > _SPINS:
                _yield_processor()


@kernel
def reset_queue(team):
    """Number the pieces of work from zero again; one thread calls this, and a barrier comes before
    any thread takes a piece."""
    _write(team.counters, _NEXT, 0)


@kernel
def take(team):
    """Number of the next piece of work that no thread has taken yet."""
    return _add_one(team.counters, _NEXT)
