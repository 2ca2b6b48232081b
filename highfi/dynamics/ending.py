"""Exit, settled window and jam of the reference, updated at every step of the time loop.

A step takes places from n to n + 1 with the velocities at n + 1/2. So the distance past the rail
end is linear within a step, speeds and rates are linear from one half step to the next, and the
integral over a step is its length times the velocity at mid-step. The order is two, as that of the
scheme.
"""

import numpy as np

from tipoff.highfi.dynamics import samples
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.state.pose import triple
from tipoff.highfi.state.records import Exit
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics import books
from tipoff.mechanics.books import (
    AT_EXIT,
    ATTITUDE,
    BEFORE,
    BODY,
    DONE,
    EXCESS,
    EXIT,
    LEAVING,
    NOW,
    PAST,
    PLACE,
    ROW_SIZE,
    SETTLED,
    SPEED,
    SPIN,
)
from tipoff.mechanics.outcome import Outcome, with_impulse


def place(system: System) -> Exit:
    """The place of the exit."""
    edges = system.faces.centre.copy()
    edges[:, 0] -= system.faces.half_length
    return Exit(edges=edges, rail_end=float(system.model.rail_end + system.body_offset[0]))


def new_book() -> np.ndarray:
    """The book (``mechanics.books``) at the beginning of a run."""
    book = np.zeros(books.BOOK_SIZE)
    books.reset(book)
    return book


def found(system: System, book: np.ndarray) -> tuple[str, Outcome]:
    """Status and outcome of a run with this book. Places in the book are those of the frame's
    origin, in the outcome those of the platform's mass centre."""
    moved, whole = (
        samples.motion(book[None, AT_EXIT : AT_EXIT + ROW_SIZE], 0.0, system.body_offset),
        book.copy(),
    )
    base = AT_EXIT + BODY
    if book[DONE] < np.inf:
        whole[base + PLACE : base + SPEED] = moved.platform_position[0]
        whole[base + SPEED : base + ATTITUDE] = moved.platform_velocity[0]
    status, result = books.found(whole)
    return status, with_impulse(result, system.model)


@inlined
def begin(constants, state, book):
    """Begin the ``book`` at ignition, with the velocities of half a step before."""
    _fill(constants.frame, constants, state, book, 0.0)
    book[PAST] = _past(constants.exit, book)
    _keep(book)
    if book[PAST] > 0.0:
        _leave(book, 1.0, 0.0, constants.milestones)


@inlined
def follow(constants, state, book, began):
    """Update the ``book`` for the step that began at ``began`` (s); places are at its end."""
    if book[DONE] < np.inf:
        return
    dt, marks = constants.dt, constants.milestones
    _fill(constants.frame, constants, state, book, 0.5)
    past = _past(constants.exit, book)
    if book[EXIT] == np.inf:
        if past > 0.0:
            share = book[PAST] / (book[PAST] - past)
            _leave(book, share, began + share * dt, marks)
        else:
            _check_speed(book, marks, began, dt)
            books.look_at_stop(book, past, began + dt, marks)
    if book[EXIT] < np.inf:
        for window in (LEAVING, SETTLED):
            low, high = books.part_in(book, window, began, began + dt)
            if high > low:
                books.count(book, window, book[NOW:], high - low)
        books.close(book, began + dt)
    book[PAST] = past
    _keep(book)


@kernel
def _keep(book):
    for i in range(ROW_SIZE):
        book[BEFORE + i] = book[NOW + i]


@inlined
def _fill(frame, constants, state, book, share):
    """Places now, and velocities and rates of half a step ago. For the rates, attitudes are taken
    ``share`` of a step back."""
    _fill_body(state.payload, constants.payload.inverse_inertia, book[NOW:], book[BEFORE:], share)
    base = NOW + BODY
    if frame.free:
        _fill_body(state.platform, frame.inverse_inertia, book[base:], book[BEFORE + BODY :], share)
        _count_from_origin(triple(frame.centre), book[base:])
    else:
        for i in range(BODY):
            book[base + i] = 0.0
        book[base + ATTITUDE] = 1.0


@kernel
def _fill_body(body, inverse_inertia, row, before, share):
    q = body.quaternion
    p, here = _four(before), 1.0 - share
    turn = rotation.matrix(
        rotation.normalised(
            (
                here * q[0] + share * p[0],
                here * q[1] + share * p[1],
                here * q[2] + share * p[2],
                here * q[3] + share * p[3],
            )
        )
    )
    rate = rotation.unrotate(
        turn, rotation.angular_velocity(turn, inverse_inertia, triple(body.spin))
    )
    for i in range(3):
        row[PLACE + i], row[SPEED + i], row[SPIN + i] = body.position[i], body.velocity[i], rate[i]
    for i in range(4):
        row[ATTITUDE + i] = q[i]


@kernel
def _count_from_origin(centre, row):
    """Convert place and velocity of the mass centre of the rigid part to those of the frame's
    origin."""
    turn, rate = rotation.matrix(_four(row)), triple(row[SPIN:])
    arm, speed = (
        rotation.rotate(turn, centre),
        rotation.rotate(turn, rotation.cross(rate, centre)),
    )
    for i in range(3):
        row[PLACE + i] -= arm[i]
        row[SPEED + i] -= speed[i]


@kernel
def _four(row):
    return (row[ATTITUDE], row[ATTITUDE + 1], row[ATTITUDE + 2], row[ATTITUDE + 3])


@kernel
def _past(exit_, book):
    """Distance (m) of the rearmost trailing edge past the rail end."""
    row, base = book[NOW:], book[NOW + BODY :]
    turn, axis = rotation.matrix(_four(row)), rotation.matrix(_four(base))
    along = rotation.unrotate(turn, (axis[0], axis[3], axis[6]))
    rearmost = np.inf
    for edge in exit_.edges:
        rearmost = min(rearmost, along[0] * edge[0] + along[1] * edge[1] + along[2] * edge[2])
    return (
        rearmost
        - exit_.rail_end
        + (
            axis[0] * (row[PLACE] - base[PLACE])
            + axis[3] * (row[PLACE + 1] - base[PLACE + 1])
            + axis[6] * (row[PLACE + 2] - base[PLACE + 2])
        )
    )


@kernel
def _leave(book, share, at, marks):
    """Fill in the exit at this ``share`` of the step: places are interpolated between both ends,
    velocities on the line through this half step and the one before."""
    for body in (0, BODY):
        for i in range(body, body + BODY):
            before, now = book[BEFORE + i], book[NOW + i]
            is_place = i < body + SPEED or body + ATTITUDE <= i < body + SPIN
            book[AT_EXIT + i] = before + (share if is_place else share + 0.5) * (now - before)
        row = book[AT_EXIT + body :]
        q = rotation.normalised(_four(row))
        for i in range(4):
            row[ATTITUDE + i] = q[i]
    books.leave(book, at, marks)


@kernel
def _check_speed(book, marks, began, dt):
    """Check the axial speed at mid-step."""
    at, start = began + 0.5 * dt, books.watched_from(marks)
    if at >= start:
        excess, crossing = abs(books.axial_speed(book[NOW:])) - marks.jam_speed, max(start, began)
        if (book[EXCESS] < 0.0) != (excess < 0.0) and not np.isnan(book[EXCESS]):
            crossing = at - dt * excess / (excess - book[EXCESS])
        books.look_at_speed(book, excess, at, crossing)
