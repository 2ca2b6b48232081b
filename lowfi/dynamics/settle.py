"""Cases without their curves: the very steps of ``lowfi.dynamics.integrate``, and the book of exit, settled
window and jam that they fill.

Bit for bit what ``lowfi.run`` finds, or no answer: a case that fails, or whose pads press at
ignition, has a message too, and is left to ``lowfi.run``.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.dynamics import audit
from tipoff.lowfi.dynamics.events import DEPTH
from tipoff.lowfi.dynamics.integrate import EVALUATIONS, NOW, SAMPLED, STEPS, advance, reset
from tipoff.lowfi.dynamics.local_error import Tolerance
from tipoff.lowfi.system import Body, System
from tipoff.mechanics.ending import BOOK_SIZE, is_over
from tipoff.scenes.effects.thrust_offset import ThrustOffset

# Columns of the results: whether the case is left to ``lowfi.run``, counts, the book.
LEFT_OPEN, TAKEN_STEPS, RIGHT_HAND_SIDES, BOOK = range(4)
RESULT_SIZE = BOOK + BOOK_SIZE


class Cases(NamedTuple):
    """What differs between n cases of f faces: mass (n,) kg and inverse inertia (n,3,3) of the
    payload, faces (n, f, FACE_SIZE), direction and arm (n,3) of the thrust or None, state at
    ignition (n, STATE_SIZE), reach (n,) m."""

    mass: np.ndarray
    inverse_inertia: np.ndarray
    faces: np.ndarray
    direction: np.ndarray | None
    arm: np.ndarray | None
    start: np.ndarray
    reach: np.ndarray


class Control(NamedTuple):
    """Relative tolerance (1), speed floor (m/s), and the first step that is tried (s)."""

    relative: float
    floor: float
    first_step: float


@kernel
def settle(common, plan, control, marks, cases, loop, results):
    """Fill ``results`` (n, RESULT_SIZE), one row per case, under the tolerance and the first step
    (s) of ``control``. Whose ledgers call for smaller steps is left open. The reach of the
    tolerance is that of each case."""
    tolerance, first_step = control
    for n in range(results.shape[0]):
        system = _system(common, cases, n)
        reset(system, cases.start[n], first_step, loop)
        allowed = Tolerance(
            tolerance.relative, tolerance.floor, cases.reach[n], tolerance.total, tolerance.across
        )
        settled = _is_settled(system, plan, allowed, marks, loop)
        affordable = audit.usage(loop.audit, tolerance.total, tolerance.across) <= 1.0
        results[n, LEFT_OPEN] = 0.0 if settled and affordable else 1.0
        results[n, TAKEN_STEPS], results[n, RIGHT_HAND_SIDES] = (
            loop.count[STEPS],
            loop.count[EVALUATIONS],
        )
        slot.copy(loop.book, results[n, BOOK:], BOOK_SIZE)


@kernel
def _system(common, cases, n):
    return System(
        Body(cases.mass[n], cases.inverse_inertia[n]),
        common.platform,
        cases.faces[n],
        common.rail_start,
        common.rail_end,
        common.thrust,
        common.reacts_on_platform,
        _offset(cases.direction, cases.arm, n),
        common.contact,
        common.compliance,
        common.friction,
        common.sticking,
        common.gravity,
        common.ledger,
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
    """Run one case until nothing is left to learn or the scene ends; False where it is left
    open."""
    if _pressed(loop):
        return False
    while loop.clock[NOW] < plan.stops[-1] and not is_over(loop.book, loop.clock[NOW]):
        if advance(system, plan, tolerance, marks, loop) != SAMPLED:
            return False
    return True


@kernel
def _pressed(loop):
    for i in range(loop.engaged.size):
        if loop.engaged[i] and loop.after[i, DEPTH] > 0.0:
            return True
    return False
