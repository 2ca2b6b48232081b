"""Exit, settled window and jam of a run, and the largest load of each guide, found step by step. Both
solvers use this module.

A time loop updates an array, the book, after every step from its own interpolant. So the outcome
does not depend on the sampling interval. The definitions are those of ``mechanics.outcome``.
"""

from typing import Any

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import entry, inlined, kernel
from tipoff.mechanics.outcome import Outcome, window_start
from tipoff.mechanics.run_limits import EXIT_WINDOW, JAM_DURATION, SETTLE_WINDOW

# A row: payload and platform, each with place (m), velocity (m/s), quaternion and rate in body axes
# (rad/s) from this offset.
PLACE, SPEED, ATTITUDE, SPIN, BODY = 0, 3, 6, 10, 13
ROW_SIZE = 2 * BODY
# Slots of a book. Times (s), infinite until they are found:
#   EXIT        the exit
#   WINDOW      start of the settled window
#   DONE        end of the settled window or of a jam, when the outcome is complete
#   LEFT        end of the window at exit, when its integrals are complete
#   SLOW_SINCE  time since which the payload is slow
# At the last step, NaN before the first one:
#   PAST        distance of the rearmost trailing edge beyond the rail end (m)
#   EXCESS      axial speed minus jam speed (m/s)
# Integrals of velocity (m) and of rate (rad), one after the other, over the completed part of:
#   SETTLED     the settled window
#   LEAVING     the window at exit
# Rows:
#   AT_EXIT, NOW, BEFORE   at the exit, at the last step, at the step before it
EXIT, WINDOW, DONE, LEFT, SLOW_SINCE, PAST, EXCESS = 0, 1, 2, 3, 4, 5, 6
SETTLED, LEAVING, AT_EXIT = 7, 13, 19
NOW, BEFORE = AT_EXIT + ROW_SIZE, AT_EXIT + 2 * ROW_SIZE
BOOK_SIZE = AT_EXIT + 3 * ROW_SIZE
# s from DONE to the end of a run, so that closely spaced samples include one after the settled
# window
AFTER = 1e-3
_ROUNDING = 1e-12  # relative; a scene that ends with the window contains it completely
# Largest loads of the guides. Columns of a row: time (s), square of the force (N2), force (N) and its
# moment about the payload's mass centre (N m), both in body axes.
TIME, SQUARE, FORCE, MOMENT, LOAD_SIZE = 0, 1, 2, 5, 8


# Rows of the largest loads, of the present instant, and of the two before it.
_LARGEST, _PRESENT, _LAST, _EARLIER = range(4)


@entry
def reset(book):
    """Set a book (BOOK_SIZE,) to the start of a run."""
    book[:] = 0.0
    book[EXIT] = book[WINDOW] = book[DONE] = book[LEFT] = book[SLOW_SINCE] = np.inf
    book[PAST] = book[EXCESS] = np.nan


@inlined
def watched_from(marks):
    """Time (s) after which a slow payload counts as jammed."""
    return 0.0 if marks.constant_thrust else marks.spent_thrust


@inlined
def leave(book, at, marks):
    """Enter the exit ``at`` (s): the last trailing edge passes the rail end."""
    book[EXIT], book[WINDOW] = at, window_start(at, marks)


@kernel
def axial_speed(row):
    """X velocity (m/s) of the payload's mass centre relative to the platform, in platform axes."""
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
    """Enter that the axial speed exceeds the jam speed by ``excess`` (m/s) ``at`` (s). ``crossing``
    (s) is the time at which it passed the jam speed, if it did so in this step."""
    if excess < 0.0 and book[SLOW_SINCE] == np.inf:
        book[SLOW_SINCE] = crossing
    if (at if excess < 0.0 else crossing) - book[SLOW_SINCE] >= JAM_DURATION:
        book[DONE] = book[SLOW_SINCE] + JAM_DURATION
    elif not excess < 0.0:
        book[SLOW_SINCE] = np.inf
    book[EXCESS] = excess


@inlined
def look_at_stop(book, past, at, marks):
    """Enter the end of a run ``at`` (s) whose payload has fallen back on its stop. ``past`` as PAST."""
    if past < marks.behind:
        book[DONE] = at


@inlined
def part_in(book, window, began, ended):
    """Start and end (s) of the part of a step inside a ``window``, SETTLED or LEAVING; for a step
    outside, the end is the smaller value."""
    if window == LEAVING:
        return max(began, book[EXIT]), min(ended, book[EXIT] + EXIT_WINDOW)
    return max(began, book[WINDOW]), min(ended, book[WINDOW] + SETTLE_WINDOW)


@inlined
def count(book, window, row, duration):
    """Add velocity and rate of ``row``, times ``duration`` (s), to the integrals of a ``window``."""
    for i in range(3):
        book[window + i] += duration * row[SPEED + i]
        book[window + 3 + i] += duration * row[SPIN + i]


@inlined
def close(book, now):
    """Enter the end of each window that is over ``now`` (s)."""
    left = book[EXIT] + EXIT_WINDOW
    if now >= left * (1.0 - _ROUNDING):
        book[LEFT] = left
    end = book[WINDOW] + SETTLE_WINDOW
    if now >= end * (1.0 - _ROUNDING):
        book[DONE] = end


@inlined
def is_over(book, now):
    """Whether a run may end ``now`` (s)."""
    return now >= book[DONE] + AFTER


@entry(forceinline=True)
def is_left_out(book, time, interval):
    """Whether the sample at ``time`` (s) is left out: it is too late, or the sample one
    ``interval`` (s) before was the last one."""
    return time > book[DONE] + AFTER or time - interval >= book[DONE]


def found(book: np.ndarray) -> tuple[str, Outcome]:
    """Status ("exited", "jammed" or "time_limit") and outcome of a run with this book
    (BOOK_SIZE,)."""
    if book[EXIT] == np.inf:
        return ("jammed" if book[DONE] < np.inf else "time_limit"), Outcome()
    at_exit = Outcome(exit_time=float(book[EXIT]))
    if book[LEFT] < np.inf:
        means = book[LEAVING : LEAVING + 6] / EXIT_WINDOW
        at_exit = at_exit._replace(exit_velocity=means[:3].tolist(), exit_rate=means[3:].tolist())
    if book[DONE] == np.inf:
        return "time_limit", at_exit
    means = book[SETTLED : SETTLED + 6] / SETTLE_WINDOW
    velocity, rate = means[:3], means[3:]
    lateral = float(np.hypot(velocity[1], velocity[2]))
    payload, platform = (
        book[AT_EXIT : AT_EXIT + BODY].tolist(),
        book[AT_EXIT + BODY : AT_EXIT + ROW_SIZE].tolist(),
    )
    return "exited", at_exit._replace(
        window_start=float(book[WINDOW]),
        velocity=velocity.tolist(),
        rate=rate.tolist(),
        lateral_velocity=lateral,
        direction_error=float(np.arctan2(lateral, velocity[0])),
        exit_attitude=rotation.vector(payload[ATTITUDE:SPIN]),
        exit_position=payload[PLACE:SPEED],
        exit_platform_position=platform[PLACE:SPEED],
        exit_platform_velocity=platform[SPEED:ATTITUDE],
        exit_platform_attitude=rotation.vector(platform[ATTITUDE:SPIN]),
        exit_platform_rate=platform[SPIN:BODY],
    )


def no_loads(guides: int) -> np.ndarray:
    """Rows (4, ``guides``, LOAD_SIZE) of no load."""
    return np.zeros((4, guides, LOAD_SIZE))


@kernel
def clear_loads(loads):
    """Begin the rows of an instant."""
    for i in range(loads.shape[1]):
        for j in range(LOAD_SIZE):
            loads[_PRESENT, i, j] = 0.0


@kernel
def add_load(loads, guide, force, moment):
    """Add a ``force`` (N) on a ``guide`` and its ``moment`` (N m) to the rows of an instant."""
    for i in range(3):
        loads[_PRESENT, guide, FORCE + i] += force[i]
        loads[_PRESENT, guide, MOMENT + i] += moment[i]


@kernel
def last_load(loads):
    """Time (s) of the last instant that was taken."""
    return loads[_LAST, 0, TIME]


@kernel
def take_loads(loads, time):
    """Keep the rows of the instant ``time`` (s) that are larger than the largest ones so far, and the peaks
    of parabolas through the last three instants."""
    for guide in range(loads.shape[1]):
        row = loads[_PRESENT, guide]
        row[TIME], row[SQUARE] = time, _square(row)
        _keep(row, loads[_LARGEST, guide])
        if row[SQUARE] < loads[_LAST, guide, SQUARE] >= loads[_EARLIER, guide, SQUARE]:
            _keep_peak(loads, guide)
        for j in range(LOAD_SIZE):
            loads[_EARLIER, guide, j], loads[_LAST, guide, j] = loads[_LAST, guide, j], row[j]


@kernel
def _square(row):
    return row[FORCE] ** 2 + row[FORCE + 1] ** 2 + row[FORCE + 2] ** 2


@kernel
def _keep(row, largest):
    if row[SQUARE] > largest[SQUARE]:
        for j in range(LOAD_SIZE):
            largest[j] = row[j]


@kernel
def _keep_peak(loads, guide):
    """Keep the load at the peak of the parabola through the squares of three instants, the middle one of
    which is the largest; uses the row before as workspace."""
    row, middle, before = loads[_PRESENT, guide], loads[_LAST, guide], loads[_EARLIER, guide]
    a, b = before[TIME] - middle[TIME], row[TIME] - middle[TIME]
    if a < 0.0 < b:
        low, high = before[SQUARE] - middle[SQUARE], row[SQUARE] - middle[SQUARE]
        bend = (high / b - low / a) / (b - a)
        at = -0.5 * (low / a - a * bend) / bend
        first, second = at * (at - b) / (a * (a - b)), at * (at - a) / (b * (b - a))
        for j in range(FORCE, LOAD_SIZE):
            before[j] = middle[j] + first * (before[j] - middle[j]) + second * (row[j] - middle[j])
        before[TIME], before[SQUARE] = middle[TIME] + at, _square(before)
        _keep(before, loads[_LARGEST, guide])


def named_loads(rows: np.ndarray) -> dict[str, Any]:
    """Rows (g, LOAD_SIZE) as the arrays of a Trajectory."""
    return {
        "guide_time": rows[:, TIME].copy(),
        "guide_force": rows[:, FORCE:MOMENT].copy(),
        "guide_moment": rows[:, MOMENT:].copy(),
    }
