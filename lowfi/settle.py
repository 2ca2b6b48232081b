"""Cases without their curves: the same steps as ``lowfi.march``,
with only the samples taken that exit and settled window are read from.

Bit for bit what ``lowfi.run`` finds, or no answer: whatever is not a plain exit, or a plain end of time, is left to ``lowfi.run``.
"""

from typing import NamedTuple

import numpy as np

from lowfi import audit
from lowfi import state as slot
from lowfi.accuracy import Tolerance
from lowfi.dormand_prince import interpolate
from lowfi.events import DEPTH
from lowfi.march import BEGAN, EVALUATIONS, NOW, SIZE, STEPS, reset, step
from lowfi.sample import RATE as MEASURED
from lowfi.sample import payload_rates, posture, rearmost_edge, relative_axial_speed
from lowfi.system import Body, System
from scenes import outcome
from scenes.effects.thrust_offset import ThrustOffset
from scenes.jit import inlined, kernel

# What became of a case.
LEFT_OPEN, EXITED, TIME_LIMIT = range(3)
ROW_SIZE = 26  # payload and platform: place, velocity, quaternion, rate
# Columns of the results: status, exit (s), start of the window (s), mean velocity (m/s) and rate (rad/s), the row at exit, counts.
STATUS, EXIT, WINDOW, VELOCITY, RATE, AT_EXIT, TAKEN_STEPS, RIGHT_HAND_SIDES = 0, 1, 2, 3, 6, 9, 9 + ROW_SIZE, 10 + ROW_SIZE
RESULT_SIZE = 11 + ROW_SIZE
_NEAR = outcome.AROUND
_CLEARLY = 1.0 + 1e-6  # beyond the threshold by more than any rounding


class Cases(NamedTuple):
    """What differs between n cases of f faces: mass (n,) kg and inverse inertia (n,3,3) of the payload, faces (n, f, FACE_SIZE),
    trailing edges (n,f,3) m, direction and arm (n,3) of the thrust or None, state at ignition (n, STATE_SIZE), reach (n,) m."""

    mass: np.ndarray
    inverse_inertia: np.ndarray
    faces: np.ndarray
    edges: np.ndarray
    direction: np.ndarray | None
    arm: np.ndarray | None
    start: np.ndarray
    reach: np.ndarray


class Scratch(NamedTuple):
    """Samples near the exit and in the window (m, ROW_SIZE), their numbers (2,2) as first and count,
    and columns (2, m) and (m,3) for splines."""

    exit: np.ndarray
    window: np.ndarray
    columns: np.ndarray
    slopes: np.ndarray


class Ends(NamedTuple):
    """Last sample number; thrust below 0.1 % and 1 % of its peak (s); whether it is constant; jam speed (m/s);
    samples between looks."""

    last: int
    settled_thrust: float
    spent_thrust: float
    constant_thrust: bool
    jam_speed: float
    stride: int


def bodies(result: np.ndarray) -> list[np.ndarray]:
    """Of one row of results, at exit: position and quaternion of the payload, position, velocity,
    quaternion and rate of the platform."""
    row = result[AT_EXIT:AT_EXIT + ROW_SIZE]
    place, base, q = slot.PLACE, slot.PLATFORM, slot.QUATERNION
    speed, spin = base + slot.VELOCITY, base + MEASURED
    return [row[place:place + 3], row[q:q + 4], row[base:base + 3], row[speed:speed + 3],
            row[base + q:base + q + 4], row[spin:spin + 3]]


def scratch(interval: float) -> Scratch:
    """Scratch for samples every ``interval`` (s)."""
    size = int(np.ceil(outcome.SETTLE_WINDOW / interval)) + 2 * _NEAR + 6
    return Scratch(np.zeros((2 * _NEAR + 2, ROW_SIZE)), np.zeros((size, ROW_SIZE)), np.zeros((2, size)), np.zeros((size, 3)))


@kernel
def settle(common, plan, tolerance, ends, cases, first_step, loop, room, results):
    """Fill ``results`` (n, RESULT_SIZE), one row per case. Whose ledgers call for smaller steps is left open. The reach of the
    ``tolerance`` is that of each case."""
    for n in range(results.shape[0]):
        system = _system(common, cases, n)
        reset(system, cases.start[n], first_step, loop)
        allowed = Tolerance(tolerance.relative, tolerance.floor, cases.reach[n], tolerance.total, tolerance.across)
        results[n, STATUS] = _one(system, plan, allowed, ends, cases.edges[n], loop, room, results[n])
        if not audit.usage(loop.audit, tolerance.total, tolerance.across) <= 1.0:
            results[n, STATUS] = LEFT_OPEN
        results[n, TAKEN_STEPS], results[n, RIGHT_HAND_SIDES] = loop.count[STEPS], loop.count[EVALUATIONS]


@kernel
def _system(common, cases, n):
    return System(Body(cases.mass[n], cases.inverse_inertia[n]), common.platform, cases.faces[n], common.rail_start,
                  common.rail_end, common.thrust, common.reacts_on_platform, _offset(cases.direction, cases.arm, n), common.contact,
                  common.walls, common.friction, common.sticking, common.gravity, common.ledger)


@kernel
def _offset(direction, arm, n):
    if direction is not None:
        return ThrustOffset((direction[n, 0], direction[n, 1], direction[n, 2]), (arm[n, 0], arm[n, 1], arm[n, 2]))
    return None


@kernel
def _one(system, plan, tolerance, ends, edges, loop, room, result):
    """Run one case; its status."""
    clock, interval = loop.clock, plan.interval
    if _pressed(loop):
        return LEFT_OPEN
    exit_rows, columns = room.exit, room.columns
    kept, number, look = 0, 0, 0  # samples in ``exit_rows``, the last of them number - 1; next sample; next look for a jam
    last, past = ends.last, -1
    before = _edge(system, loop, exit_rows[exit_rows.shape[0] - 1])
    while past < 0 and number <= last:
        if clock[NOW] < number * interval:
            if loop.count[STEPS] >= plan.maximum_steps or not step(system, plan, tolerance, loop):
                return LEFT_OPEN
            if not _finite(loop.end):
                return LEFT_OPEN
        after = _edge(system, loop, exit_rows[exit_rows.shape[0] - 1])
        rise, ahead = _course(loop, before, after, interval)
        while past < 0 and number <= last and number * interval <= clock[NOW]:
            if before + rise * (number * interval - clock[BEGAN]) + ahead >= system.rail_end:
                if kept == _NEAR + 1:
                    for i in range(_NEAR):
                        slot.copy(exit_rows[i + 1], exit_rows[i], ROW_SIZE)
                    kept = _NEAR
                _sample(system, loop, number * interval, exit_rows[kept])
                kept += 1
                if rearmost_edge(system.faces, system.platform, exit_rows[kept - 1]) > system.rail_end:
                    past = number
            else:
                kept = 0
            if number == look or number == last:
                look += ends.stride
                if past < 0 and _slow(system, loop, number * interval, ends, room.window[0]):
                    return LEFT_OPEN
            number += 1
        before = after
    if past < 0:
        return TIME_LIMIT
    if kept < _NEAR + 1 or past < _NEAR:
        return LEFT_OPEN
    exit_at = _exit(system, edges, exit_rows[:kept], past - _NEAR, _NEAR, interval, columns, room.slopes)
    window = max(exit_at + outcome.SETTLE_DELAY, ends.settled_thrust)
    last = min(last, int(np.ceil((window + outcome.SETTLE_WINDOW) / interval)) + 2)
    every = outcome.thinning(interval)
    # More than the spline needs, for the exit is found once more.
    first = last - every * ((last - int(window / interval) + 2) // every + _NEAR)
    stored = 0
    while number <= last:
        while clock[NOW] < number * interval:
            if loop.count[STEPS] >= plan.maximum_steps or not step(system, plan, tolerance, loop):
                return LEFT_OPEN
            if not _finite(loop.end):
                return LEFT_OPEN
        if kept < 2 * _NEAR:
            _sample(system, loop, number * interval, exit_rows[kept])
            kept += 1
        if number >= first and (last - number) % every == 0:
            if stored == room.window.shape[0]:
                return LEFT_OPEN
            _sample_payload(system, loop, number * interval, room.window[stored])
            stored += 1
        number += 1
    first = last - every * (stored - 1)
    exit_at = _exit(system, edges, exit_rows[:kept], past - _NEAR, _NEAR, interval, columns, room.slopes)
    slot.copy(exit_rows[_NEAR], result[AT_EXIT:], ROW_SIZE)
    return _judge(exit_at, max(exit_at + outcome.SETTLE_DELAY, ends.settled_thrust), first, every, room.window[:stored], interval,
                  columns, room.slopes, result)


@kernel
def _judge(exit_at, start, first, every, rows, interval, columns, slopes, result):
    """The settled values of samples ``rows``, which are those of number ``first`` and each ``every``-th after it."""
    end, stored = start + outcome.SETTLE_WINDOW, rows.shape[0]
    last = first + every * (stored - 1)
    if last * interval < end * (1.0 - 1e-12):
        return LEFT_OPEN
    inside, beyond = int(start / interval), int(end / interval)  # first samples in the window and past it
    while inside * interval < start:
        inside += 1
    while beyond * interval < end:
        beyond += 1
    if min(beyond + _NEAR - 1, last) != last or inside - _NEAR * every < first:
        return LEFT_OPEN  # the exit, found once more, asks for other samples
    begin = -(-(inside - _NEAR * every - first) // every)
    count = stored - begin
    if count < 4:
        return LEFT_OPEN
    time, work, slope = columns[0, :count], columns[1, :count], slopes[:count]
    for i in range(count):
        time[i] = (first + every * (begin + i)) * interval
    kept = rows[begin:]
    outcome.average(time, kept[:, slot.VELOCITY:slot.VELOCITY + 3], start, end, work, slope, result[VELOCITY:])
    outcome.average(time, kept[:, MEASURED:MEASURED + 3], start, end, work, slope, result[RATE:])
    result[EXIT], result[WINDOW] = exit_at, start
    return EXITED


@kernel
def _exit(system, edges, rows, first, after, interval, columns, slopes):
    """Exit (s) from samples ``rows`` (n, ROW_SIZE), the first of which is number ``first``, between ``after`` - 1 and ``after``."""
    count = rows.shape[0]
    time, work, past, slope = columns[0, :count], columns[1, :count], slopes[:count, 0:1], slopes[:count, 1:2]
    for i in range(count):
        time[i] = (first + i) * interval
    body, base = slot.PAYLOAD, slot.PLATFORM
    outcome.distances(rows[:, body:body + 3], rows[:, body + slot.QUATERNION:body + slot.MOMENT], rows[:, base:base + 3],
                      rows[:, base + slot.QUATERNION:base + slot.MOMENT], edges, system.rail_end, past)
    return outcome.crossed(time, past, after, work, slope)


@kernel
def _sample(system, loop, time, row):
    """Motion at ``time`` (s), inside the last step."""
    clock = loop.clock
    if time == clock[NOW]:
        slot.copy(loop.end, loop.work, slot.STATE_SIZE)
    else:
        interpolate(clock[SIZE], (time - clock[BEGAN]) / clock[SIZE], loop.start, loop.stages, slot.DYNAMIC_SIZE, 0, loop.work)
    posture(system, loop.work, row)


@inlined
def _sample_payload(system, loop, time, row):
    """The same of the payload alone, its places apart."""
    clock = loop.clock
    if time == clock[NOW]:
        slot.copy(loop.end, loop.work, slot.BODY_SIZE)
    else:
        interpolate(clock[SIZE], (time - clock[BEGAN]) / clock[SIZE], loop.start, loop.stages, slot.BODY_SIZE, 0, loop.work)
    payload_rates(system.payload, loop.work, row)


@inlined
def _edge(system, loop, row):
    posture(system, loop.end, row)
    return rearmost_edge(system.faces, system.platform, row)


@inlined
def _course(loop, before, after, interval):
    """Mean speed (m/s) of the rearmost edge in the last step, and how far (m) a sample may lie ahead of the chord and still matter.

    A cubic leaves its chord by at most 4/27 h (|v0 - c| + |v1 - c|); twice that is allowed,
    and the samples that an exit needs before it.
    """
    lasted = loop.clock[NOW] - loop.clock[BEGAN]
    chord = (after - before) / lasted if lasted > 0.0 else 0.0
    bend = abs(_speed(loop.start) - chord) + abs(_speed(loop.end) - chord)
    return chord, 0.3 * lasted * bend + (2 + _NEAR) * interval * abs(chord) + 1e-6


@inlined
def _speed(state):
    return state[slot.VELOCITY] - state[slot.PLATFORM + slot.VELOCITY]


@kernel
def _slow(system, loop, time, ends, row):
    """Whether the payload may have come to rest on the rail at ``time`` (s)."""
    if time < outcome.JAM_DURATION or not (ends.constant_thrust or time - outcome.JAM_DURATION >= ends.spent_thrust):
        return False
    _sample(system, loop, time, row)
    return not abs(relative_axial_speed(system.platform, row)) > ends.jam_speed * _CLEARLY


@inlined
def _finite(state):
    total = 0.0
    for j in range(state.size):
        total += abs(state[j])
    return np.isfinite(total)


@kernel
def _pressed(loop):
    for i in range(loop.engaged.size):
        if loop.engaged[i] and loop.after[i, DEPTH] > 0.0:
            return True
    return False
