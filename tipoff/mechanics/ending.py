"""What a time loop learns of exit, settled window and jam, step by step: one book for both
fidelities.

A loop feeds its book after every step, from its own interpolant, so what becomes of a payload does
not hang on when the motion is sampled. The definitions are those of ``mechanics.outcome``.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics.outcome import JAM_DURATION, SETTLE_WINDOW, Outcome, window_start

# A row: payload and platform, each with place (m), velocity (m/s), quaternion and rate in body axes
# (rad/s) from here on.
PLACE, SPEED, ATTITUDE, SPIN, BODY = 0, 3, 6, 10, 13
ROW_SIZE = 2 * BODY
# Slots of a book. Instants (s), infinite until they are known: the exit, the begin of the settled
# window, the end of it or of a jam, after which nothing is left to learn, the one since when the
# payload is slow. At the last look: how far the rearmost trailing edge is past the rail end (m),
# and by how much the axial speed exceeds the jam speed (m/s), both NaN before a first look.
# Integrals over the window so far of velocity (m) and rate (rad). Rows at the exit, at the last
# look and at the one before.
EXIT, WINDOW, DONE, SLOW_SINCE, PAST, EXCESS, WAY, ANGLE, AT_EXIT = 0, 1, 2, 3, 4, 5, 6, 9, 12
NOW, BEFORE = AT_EXIT + ROW_SIZE, AT_EXIT + 2 * ROW_SIZE
BOOK_SIZE = AT_EXIT + 3 * ROW_SIZE
# s after which a run ends when nothing is left to learn: time for one more sample, if samples are
# so close that a record of them tells of the settled window.
AFTER = 1e-3
_ROUNDING = 1e-12  # relative: a scene that ends with the window holds all of it


@kernel
def reset(book):
    """Bring a book (BOOK_SIZE,) of any past to the begin of a run."""
    book[:] = 0.0
    book[EXIT] = book[WINDOW] = book[DONE] = book[SLOW_SINCE] = np.inf
    book[PAST] = book[EXCESS] = np.nan


@inlined
def watched_from(marks):
    """Instant (s) from which on a slow payload may be jammed."""
    return 0.0 if marks.constant_thrust else marks.spent_thrust


@inlined
def leave(book, at, marks):
    """The last trailing edge passes the rail end ``at`` (s)."""
    book[EXIT], book[WINDOW] = at, window_start(at, marks)


@kernel
def axial_speed(row):
    """X velocity (m/s) of the payload's mass centre as seen from the platform, in its axes."""
    base = row[BODY:]
    axis = rotation.matrix(
        (base[ATTITUDE], base[ATTITUDE + 1], base[ATTITUDE + 2], base[ATTITUDE + 3])
    )
    spin = rotation.rotate(axis, (base[SPIN], base[SPIN + 1], base[SPIN + 2]))
    swing = rotation.cross(spin, (row[0] - base[0], row[1] - base[1], row[2] - base[2]))
    return (
        axis[0] * (row[SPEED] - base[SPEED] - swing[0])
        + axis[3] * (row[SPEED + 1] - base[SPEED + 1] - swing[1])
        + axis[6] * (row[SPEED + 2] - base[SPEED + 2] - swing[2])
    )


@inlined
def look_at_speed(book, excess, at, crossing):
    """The axial speed exceeds the jam speed by ``excess`` (m/s) ``at`` (s), and passed it at
    ``crossing`` (s) if it did so since the last look."""
    if excess < 0.0 and book[SLOW_SINCE] == np.inf:
        book[SLOW_SINCE] = crossing
    if (at if excess < 0.0 else crossing) - book[SLOW_SINCE] >= JAM_DURATION:
        book[DONE] = book[SLOW_SINCE] + JAM_DURATION
    elif not excess < 0.0:
        book[SLOW_SINCE] = np.inf
    book[EXCESS] = excess


@inlined
def part_in_window(book, began, ended):
    """Begin and end (s) of the part of a step that lies in the settled window; not in this order
    where none does."""
    return max(began, book[WINDOW]), min(ended, book[WINDOW] + SETTLE_WINDOW)


@inlined
def count(book, row, duration):
    """Add to the integrals that velocity and rate are those of ``row`` for ``duration`` (s)."""
    for i in range(3):
        book[WAY + i] += duration * row[SPEED + i]
        book[ANGLE + i] += duration * row[SPIN + i]


@inlined
def close(book, now):
    """See whether the settled window is over ``now`` (s)."""
    end = book[WINDOW] + SETTLE_WINDOW
    if now >= end * (1.0 - _ROUNDING):
        book[DONE] = end


@inlined
def is_over(book, now):
    """Whether a run may end ``now`` (s)."""
    return now >= book[DONE] + AFTER


@inlined
def is_left_out(book, time, interval):
    """Whether a sample at ``time`` (s) is not taken any more: it comes late, or one ``interval``
    (s) before it was the last."""
    return time > book[DONE] + AFTER or time - interval >= book[DONE]


def found(book: np.ndarray) -> tuple[str, Outcome]:
    """Status ("exited", "jammed" or "time_limit") and outcome of a run with this book
    (BOOK_SIZE,)."""
    if book[EXIT] == np.inf:
        return ("jammed" if book[DONE] < np.inf else "time_limit"), Outcome()
    if book[DONE] == np.inf:
        return "time_limit", Outcome(exit_time=float(book[EXIT]))
    velocity, rate = book[WAY : WAY + 3] / SETTLE_WINDOW, book[ANGLE : ANGLE + 3] / SETTLE_WINDOW
    lateral = float(np.hypot(velocity[1], velocity[2]))
    payload, platform = (
        book[AT_EXIT : AT_EXIT + BODY].tolist(),
        book[AT_EXIT + BODY : AT_EXIT + ROW_SIZE].tolist(),
    )
    return "exited", Outcome(
        float(book[EXIT]),
        float(book[WINDOW]),
        velocity.tolist(),
        rate.tolist(),
        lateral,
        float(np.arctan2(lateral, velocity[0])),
        rotation.vector(payload[ATTITUDE:SPIN]),
        payload[PLACE:SPEED],
        platform[PLACE:SPEED],
        platform[SPEED:ATTITUDE],
        rotation.vector(platform[ATTITUDE:SPIN]),
        platform[SPIN:BODY],
    )
