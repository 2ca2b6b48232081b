"""Exit, settled window and jam of the surrogate, found on the interpolant of every step.

A step is divided into pieces. If a piece begins and ends on different sides of the rail end or of
the jam speed, the crossing is found by regula falsi (Illinois variant) to rounding. Means over the
window are integrals of the interpolant by Gauss-Legendre quadrature::

    integral over h = h / 2 sum_k w_k f(t_k)         error <= 4e-13 h^11 max |f^(10)|  (five points)

The velocity is a polynomial of degree four in a step, which the rule integrates exactly. The rate
in body axes is not; it changes with up to twice the angle of the attitude. At a relative tolerance
of 1e-2, the loosest allowed, a step may turn by 4 rad, and the error is 3e-4 of the rate; at 1e-4
the values are 1.2 rad and 2e-9.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.dynamics.dormand_prince import interpolate
from tipoff.lowfi.dynamics.sample import posture, rearmost_edge
from tipoff.mechanics import books
from tipoff.mechanics.books import (
    AT_EXIT,
    DONE,
    EXCESS,
    EXIT,
    LEAVING,
    NOW,
    PAST,
    ROW_SIZE,
    SETTLED,
)

# s, longest piece of a step: a body that leaves the rail, or starts to move, and returns sooner may
# be missed
PIECE = 1e-3
_EDGE, _SPEED = range(2)  # quantities
_ROUNDING = 1e-15  # of places (m) and speeds (m/s)
_POINTS = np.array(
    [-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640]
)
_WEIGHTS = np.array(
    [
        0.2369268850561891,
        0.4786286704993665,
        0.5688888888888889,
        0.4786286704993665,
        0.2369268850561891,
    ]
)


class Step(NamedTuple):
    """An accepted step."""

    began: float  # s
    ended: float  # s
    size: float  # s, before an event cut it


@kernel
def follow(system, marks, loop, step):
    """Update the book of ``loop`` for the accepted ``step``."""
    book = loop.book
    if book[DONE] < np.inf:
        return
    if book[EXIT] == np.inf:
        _monitor(system, marks, loop, step)
    if book[EXIT] < np.inf:
        _count(system, loop, step)


@kernel
def _monitor(system, marks, loop, step):
    """Find the exit and a jam."""
    book = loop.book
    if np.isnan(book[PAST]):
        book[PAST] = _quantity(_EDGE, system, marks, loop, step, step.began)
        if book[PAST] > 0.0:
            _leave(system, marks, loop, step, step.began)
            return
    pieces, begin = int(np.ceil((step.ended - step.began) / PIECE)), step.began
    for piece in range(1, pieces + 1):
        end = (
            step.ended
            if piece == pieces
            else step.began + (step.ended - step.began) * piece / pieces
        )
        past = _quantity(_EDGE, system, marks, loop, step, end)
        if past > 0.0:
            _leave(
                system,
                marks,
                loop,
                step,
                _crossing(_EDGE, system, marks, loop, step, (begin, end), (book[PAST], past)),
            )
            return
        book[PAST] = past
        books.look_at_stop(book, past, end, marks)
        _look_at_speed(system, marks, loop, step, begin, end)
        if book[DONE] < np.inf:
            return
        begin = end


@kernel
def _leave(system, marks, loop, step, at):
    _fill(system, loop, step, at)
    slot.copy(loop.book[NOW:], loop.book[AT_EXIT:], ROW_SIZE)
    books.leave(loop.book, at, marks)


@kernel
def _look_at_speed(system, marks, loop, step, begin, end):
    """Check the axial speed at the ``end`` (s) of a piece, and at the first moment from which it
    counts."""
    book, low = loop.book, max(begin, books.watched_from(marks))
    if low > end:
        return
    if np.isnan(book[EXCESS]):
        books.look_at_speed(book, _quantity(_SPEED, system, marks, loop, step, low), low, low)
    excess, crossing = _quantity(_SPEED, system, marks, loop, step, end), end
    if (book[EXCESS] < 0.0) != (excess < 0.0):
        crossing = _crossing(_SPEED, system, marks, loop, step, (low, end), (book[EXCESS], excess))
    books.look_at_speed(book, excess, end, crossing)


@kernel
def _count(system, loop, step):
    """Add the parts of the step that are in the window at exit and in the settled window."""
    book = loop.book
    for window in (LEAVING, SETTLED):
        begin, end = books.part_in(book, window, step.began, step.ended)
        if end > begin:
            for k in range(_POINTS.size):
                _fill(system, loop, step, 0.5 * (begin + end) + 0.5 * (end - begin) * _POINTS[k])
                books.count(book, window, book[NOW:], 0.5 * (end - begin) * _WEIGHTS[k])
    books.close(book, step.ended)


@kernel
def _crossing(kind, system, marks, loop, step, between, values):
    """Time (s) in ``between`` at which a quantity passes zero; its ``values`` at both ends have
    different signs."""
    (low, high), (f_low, f_high) = between, values
    side = 0
    for _ in range(60):
        at = (low * f_high - high * f_low) / (f_high - f_low)
        if not low < at < high:
            break
        f = _quantity(kind, system, marks, loop, step, at)
        if abs(f) <= _ROUNDING:
            return at
        if (f > 0.0) == (f_high > 0.0):
            high, f_high = at, f
            f_low = 0.5 * f_low if side == 1 else f_low
            side = 1
        else:
            low, f_low = at, f
            f_high = 0.5 * f_high if side == -1 else f_high
            side = -1
    return low if abs(f_low) < abs(f_high) else high


@kernel
def _quantity(kind, system, marks, loop, step, time):
    """At ``time`` (s): distance (m) of the rearmost trailing edge past the rail end, or the excess
    (m/s) of the axial speed."""
    _fill(system, loop, step, time)
    if kind == _EDGE:
        return rearmost_edge(system.faces, system.platform, loop.book[NOW:]) - system.rail_end
    return abs(books.axial_speed(loop.book[NOW:])) - marks.jam_speed


@kernel
def _fill(system, loop, step, time):
    """Motion at ``time`` (s) in the step into the book."""
    if time == step.ended:
        slot.copy(loop.end, loop.work, slot.STATE_SIZE)
    elif time == step.began:
        slot.copy(loop.start, loop.work, slot.STATE_SIZE)
    else:
        theta = (time - step.began) / step.size
        interpolate(system, loop, step.size, theta, slot.MOVING_SIZE, loop.work)
    posture(system, loop.work, loop.book[NOW:])
