"""Runs without curves: the same steps as ``lowfi.dynamics.integrate``, and the book of exit, settled
window and jam.

The results are those of ``lowfi.run``, bit for bit, or none: a case that fails, or whose pads press
at ignition, needs a message too, and is left to ``lowfi.run``.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import entry, kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.wall_ends import DEPTH
from tipoff.lowfi.dynamics import audit
from tipoff.lowfi.dynamics.integrate import SAMPLED, advance, reset
from tipoff.lowfi.dynamics.local_error import Tolerance
from tipoff.lowfi.system import Body, System
from tipoff.mechanics.ending import BOOK_SIZE, is_over
from tipoff.scenes.effects.thrust_offset import ThrustOffset

# Columns of the results: whether the case is left to ``lowfi.run``, steps, the book.
LEFT_OPEN, STEPS, BOOK = range(3)
RESULT_SIZE = BOOK + BOOK_SIZE


class Cases(NamedTuple):
    """What differs between n cases of f faces."""

    mass: np.ndarray  # (n,) kg, of the payload
    inverse_inertia: np.ndarray  # (n, 3, 3) 1/(kg m2), of the payload
    faces: np.ndarray  # (n, f, FACE_SIZE)
    direction: np.ndarray | None  # (n, 3) of the thrust; None without thrust offset
    arm: np.ndarray | None  # (n, 3) m, of the thrust; None without thrust offset
    start: np.ndarray  # (n, STATE_SIZE) state at ignition
    reach: np.ndarray  # (n,) m, as in ``Tolerance``


@entry
def run_cases(common, plan, control, marks, cases, loop, results):
    """Fill ``results`` (n, RESULT_SIZE), one row per case. ``control`` is the tolerance, but for the
    reach, and the first step (s). A case whose ledgers need smaller steps is left open."""
    tolerance, first_step = control
    for n in range(results.shape[0]):
        system = _system(common, cases, n)
        reset(system, cases.start[n], first_step, loop)
        allowed = Tolerance(
            relative=tolerance.relative,
            floor=tolerance.floor,
            reach=cases.reach[n],
            total=tolerance.total,
            transverse=tolerance.transverse,
        )
        settled = _is_settled(system, plan, allowed, marks, loop)
        affordable = audit.usage(loop.audit, tolerance.total, tolerance.transverse) <= 1.0
        results[n, LEFT_OPEN] = 0.0 if settled and affordable else 1.0
        results[n, STEPS] = loop.counts.steps
        slot.copy(loop.book, results[n, BOOK:], BOOK_SIZE)


@kernel
def _system(common, cases, n):
    return System(
        payload=Body(cases.mass[n], cases.inverse_inertia[n]),
        platform=common.platform,
        faces=cases.faces[n],
        rail_start=common.rail_start,
        rail_end=common.rail_end,
        thrust=common.thrust,
        reacts_on_platform=common.reacts_on_platform,
        thrust_offset=_offset(cases.direction, cases.arm, n),
        contact=common.contact,
        compliance=common.compliance,
        has_contact=common.has_contact,
        is_compliant=common.is_compliant,
        friction=common.friction,
        sticking=common.sticking,
        body_force=common.body_force,
        ledger=common.ledger,
    )


@kernel
def _offset(direction, arm, n):
    if direction is not None:
        return ThrustOffset(
            (direction[n, 0], direction[n, 1], direction[n, 2]), (arm[n, 0], arm[n, 1], arm[n, 2])
        )
    return None


@kernel
def _is_settled(system, plan, tolerance, marks, loop):
    """Run one case until exit and jam are known or the scene ends; False where it is left open."""
    if _presses(loop):
        return False
    while loop.clock.now < plan.stops[-1] and not is_over(loop.book, loop.clock.now):
        if advance(system, plan, tolerance, marks, loop) != SAMPLED:
            return False
    return True


@kernel
def _presses(loop):
    for i in range(loop.engaged.size):
        if loop.engaged[i] and loop.after[i, DEPTH] > 0.0:
            return True
    return False
