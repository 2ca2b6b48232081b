"""The time loop: steps as long as error, events and the proven limit allow, samples on their own grid in between."""

from typing import NamedTuple

import numpy as np

from lowfi import state as slot
from lowfi.accuracy import error_ratio
from lowfi.dormand_prince import STABLE_RADIUS, STAGES, attempt, interpolate
from lowfi.events import SOONEST, SURVEY_SIZE, felt, first_event, on_rail, survey
from lowfi.limits import fastest_rate
from lowfi.sample import observe, rearmost_edge
from scenes.jit import njit

# What ``march`` returns: all samples taken, or why it stopped before.
SAMPLED, PASSED, UNDERFLOW, OUT_OF_STEPS, NOT_FINITE = range(5)
# Slots of Loop.clock: ends and size of the last step (s), step the controller wants (s), bound of the contact's rates at the end
# (1/s), smallest proven limit met (s), largest step over its limit (1), largest friction and damping power (W, not above zero).
BEGAN, NOW, SIZE, WANTED, RATE, LIMIT, LIMIT_USED, FRICTION_POWER, DAMPING_POWER, CLOCK_SIZE = range(10)
# Slots of Loop.count.
SEGMENT, STEPS, REJECTED, EVENTS, EVALUATIONS, TAKEN, COUNT_SIZE = range(7)
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 5.0
_LANDINGS = 40  # attempts to end one step at an event


class Plan(NamedTuple):
    """Times (s) a step must end at, the longest step (s) before each, the time between samples (s), the step budget."""

    stops: np.ndarray
    caps: np.ndarray
    interval: float
    maximum_steps: int


class Loop(NamedTuple):
    """What evolves: states at the ends of the last step, its stages, surveys of its ends, faces on the rail and those felt in the last step,
    clock and counts."""

    start: np.ndarray
    end: np.ndarray
    stages: np.ndarray
    before: np.ndarray
    after: np.ndarray
    engaged: np.ndarray
    active: np.ndarray
    clock: np.ndarray
    count: np.ndarray
    work: np.ndarray


def ready(system, state: np.ndarray, first_step: float) -> Loop:
    """A loop about to take its first sample of ``system`` at ``state`` (STATE_SIZE,), and its first step of ``first_step`` (s)."""
    clock, count, faces = np.zeros(CLOCK_SIZE), np.zeros(COUNT_SIZE, dtype=np.int64), system.faces.shape[0]
    clock[WANTED], clock[LIMIT], count[SEGMENT] = first_step, np.inf, -1
    clock[FRICTION_POWER] = clock[DAMPING_POWER] = -np.inf
    after, engaged = np.zeros((faces, SURVEY_SIZE)), np.zeros(faces, dtype=np.bool_)
    survey(system.contact, system.faces, system.platform, system.payload, engaged, state, after)
    on_rail(system.contact, system.rail_start, system.rail_end, after, engaged)
    return Loop(state.copy(), state.copy(), np.zeros((STAGES, slot.STATE_SIZE)), np.zeros_like(after), after, engaged,
                np.zeros_like(engaged), clock, count, np.zeros(slot.STATE_SIZE))


@njit
def march(system, plan, tolerance, loop, last, until_passed, rows, forces):
    """Take samples up to number ``last`` into ``rows`` (n, SAMPLE_SIZE) and ``forces`` (n, f, 3), or, if ``until_passed``, up to the
    first one with every trailing edge past the rail end."""
    clock, count = loop.clock, loop.count
    for number in range(count[TAKEN], last + 1):
        time = number * plan.interval
        while clock[NOW] < time:
            if count[STEPS] >= plan.maximum_steps:
                return OUT_OF_STEPS
            if not step(system, plan, tolerance, loop):
                return UNDERFLOW
        if time == clock[NOW]:
            slot.copy(loop.end, loop.work, slot.STATE_SIZE)
        else:
            interpolate(clock[SIZE], (time - clock[BEGAN]) / clock[SIZE], loop.start, loop.stages, slot.STATE_SIZE, loop.work)
        if not observe(system, loop.engaged, loop.work, rows[number], forces[number]):
            return NOT_FINITE
        count[TAKEN] += 1
        if until_passed and rearmost_edge(system.faces, system.platform, rows[number]) > system.rail_end:
            return PASSED
    return SAMPLED


@njit
def step(system, plan, tolerance, loop):
    """Take one step; False when none is short enough."""
    clock, count = loop.clock, loop.count
    fresh = _begin(system.contact, system.rail_start, system.rail_end, plan, loop)
    start, segment = clock[BEGAN], count[SEGMENT]
    stop, rate, landings = plan.stops[segment], clock[RATE], 0
    # At a corner the thrust is the one of the stretch it is seen from.
    stretch = (np.nextafter(0.0 if segment == 0 else plan.stops[segment - 1], np.inf), np.nextafter(stop, -np.inf))
    ceiling = min(plan.caps[segment], STABLE_RADIUS / rate)
    while True:
        dt = min(clock[WANTED], ceiling)
        reaches = start + dt * (1.0 + 1e-9) >= stop
        dt = stop - start if reaches else dt
        if start + dt == start or not dt > 0.0:
            return False
        attempt(system, loop.active, stretch, start, dt, fresh, loop.start, loop.stages, loop.end)
        count[EVALUATIONS] += STAGES if fresh else STAGES - 1
        fresh = False
        ratio = error_ratio(tolerance, system.payload, system.platform, dt, loop.stages, loop.end, loop.work)
        if not ratio <= 1.0:
            count[REJECTED] += 1
            clock[WANTED] = dt * (max(_SHRINK, _SAFETY * ratio**-0.2) if ratio < np.inf else _SHRINK)
            continue
        touching = survey(system.contact, system.faces, system.platform, system.payload, loop.engaged, loop.end, loop.after)
        clock[RATE] = 0.0
        if touching:
            clock[RATE] = fastest_rate(system.contact, system.friction, system.faces, system.platform, system.payload, loop.engaged,
                                       loop.end)
        limit = STABLE_RADIUS / max(rate, clock[RATE])
        if dt > limit * (1.0 + 1e-12):
            count[REJECTED] += 1
            clock[WANTED] = _SAFETY * limit
            continue
        theta, face = first_event(system.contact, system.payload, system.platform, system.faces, (system.rail_start, system.rail_end),
                            loop.engaged, loop.before, loop.after, dt, loop.start, loop.stages, loop.work)
        if theta < 1.0 - 1e-9 and landings < _LANDINGS:
            landings += 1
            if theta > SOONEST and start + 0.01 * theta * dt > start:
                ceiling = theta * dt
                continue
            if not loop.active[face]:  # it touches as the step begins, by rounding on the wrong side
                loop.active[face] = fresh = True
                continue
        _accept(loop.stages[STAGES - 1], clock, count, dt, stop if reaches else start + dt, ratio, limit)
        count[EVENTS] += landings
        return True


@njit
def _begin(laws, rail_start, rail_end, plan, loop):
    """Make the end of the last step the start of the next; what jumps in between jumps here. True when the derivative jumps too."""
    clock, count = loop.clock, loop.count
    slot.copy(loop.end, loop.start, slot.STATE_SIZE)
    clock[BEGAN] = clock[NOW]
    fresh = count[SEGMENT] < 0 or clock[NOW] >= plan.stops[count[SEGMENT]]
    if fresh:
        count[SEGMENT] += 1
    changed, energy = on_rail(laws, rail_start, rail_end, loop.after, loop.engaged)
    loop.start[slot.RELEASED] += energy
    for i in range(loop.engaged.size):
        slot.copy(loop.after[i], loop.before[i], SURVEY_SIZE)
    slot.copy(loop.stages[STAGES - 1], loop.stages[0], slot.STATE_SIZE)
    return felt(loop.after, loop.engaged, loop.active) or fresh or changed


@njit
def _accept(derivative, clock, count, dt, time, ratio, limit):
    grown = dt * (min(_GROW, _SAFETY * ratio**-0.2) if ratio > 0.0 else _GROW)
    # A step cut short by an event or a corner says little about the next one.
    clock[WANTED] = grown if dt >= clock[WANTED] else max(grown, clock[WANTED])
    clock[NOW], clock[SIZE] = time, dt
    clock[LIMIT], clock[LIMIT_USED] = min(clock[LIMIT], limit), max(clock[LIMIT_USED], dt / limit)
    clock[FRICTION_POWER] = max(clock[FRICTION_POWER], -derivative[slot.FRICTION])
    clock[DAMPING_POWER] = max(clock[DAMPING_POWER], -derivative[slot.DAMPING])
    count[STEPS] += 1
