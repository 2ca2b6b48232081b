"""Threads that share one run: they take the same steps side by side and meet at barriers.

The barrier spins, because a step lasts tens of microseconds; a thread that waits for long offers
its processor to others.
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

_ROUND, _ARRIVED, _TICKET = 0, 8, 16  # a cache line apart
_PATIENCE = 4000  # looks at the barrier before the processor is offered to others


class Team(NamedTuple):
    """``size`` threads, the ``counters`` of their barrier and of their tickets, and room of its own
    for each: (4, LANES) ``lanes``, which also hold the forces of one element."""

    size: int
    counters: np.ndarray
    lanes: np.ndarray


def gather(size: int) -> Team:
    """A team of ``size`` threads, none of them at work yet."""
    return Team(size, np.zeros(24, dtype=np.int64), zeros((size, 4, LANES)))


def processors() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _element(context, builder, signature, arguments):
    data = context.make_array(signature.args[0])(context, builder, value=arguments[0]).data
    return builder.gep(data, [arguments[1]])


@intrinsic
def _add_one(typing, counters, index):
    """counters[index] += 1 in one piece; returns the value before."""

    def generate(context, builder, signature, arguments):
        place = _element(context, builder, signature, arguments)
        return builder.atomic_rmw("add", place, ir.Constant(ir.IntType(64), 1), "seq_cst")

    return types.int64(counters, types.intp), generate


@intrinsic
def _read(typing, counters, index):
    """counters[index] as other threads left it, with all they wrote before."""

    def generate(context, builder, signature, arguments):
        return builder.load_atomic(_element(context, builder, signature, arguments), "seq_cst", 8)

    return types.int64(counters, types.intp), generate


@intrinsic
def _write(typing, counters, index, value):
    """counters[index] = value, and all written before it, for every thread that reads it."""

    def generate(context, builder, signature, arguments):
        builder.store_atomic(
            arguments[2], _element(context, builder, signature, arguments), "seq_cst", 8
        )
        return context.get_dummy_value()

    return types.void(counters, types.intp, types.int64), generate


@intrinsic
def _let_others_run(typing):
    """Offer the processor to other threads, where the system has a call for it."""

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
def meet(team):
    """Wait until every thread of the team is here."""
    if team.size > 1:
        counters = team.counters
        now = _read(counters, _ROUND)
        if _add_one(counters, _ARRIVED) == team.size - 1:
            _write(counters, _ARRIVED, 0)
            _write(counters, _ROUND, now + 1)
        looks = 0
        while _read(counters, _ROUND) == now:
            looks += 1
            if looks > _PATIENCE:
                _let_others_run()


@kernel
def deal(team):
    """Let tickets start from zero again; one thread calls this where no other one takes any before
    they have met."""
    _write(team.counters, _TICKET, 0)


@kernel
def take(team):
    """The number of the next piece of work that no thread has taken yet."""
    return _add_one(team.counters, _TICKET)
