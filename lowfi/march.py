"""The time loop: steps as long as error, events and the proven limit allow, samples on their own grid in between."""

from typing import NamedTuple

import numpy as np

from lowfi import state as slot
from lowfi.accuracy import error_ratio
from lowfi.dormand_prince import STABLE_RADIUS, STAGES, attempt, interpolate
from lowfi.equations import derivative
from lowfi.events import SURVEY_SIZE, first_event, on_rail, survey
from lowfi.limits import fastest_rate
from lowfi.sample import observe
from scenes.jit import njit

# What ``march`` returns.
SAMPLED, UNDERFLOW, OUT_OF_STEPS, NOT_FINITE = 0, 1, 2, 3
# Slots of Loop.clock: ends and size of the last step (s), step the controller wants (s), open stretch between two corners of the
# thrust (s), bound of the contact's rates at the end (1/s), smallest proven limit met (s), largest step over its limit (1), largest
# friction and damping power (W, not above zero).
BEGAN, NOW, SIZE, WANTED, FIRST, LAST, RATE, LIMIT, LIMIT_USED, FRICTION_POWER, DAMPING_POWER = range(11)
# Slots of Loop.count.
SEGMENT, STEPS, REJECTED, EVENTS, EVALUATIONS, TAKEN = range(6)
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 5.0
_LANDINGS = 40  # attempts to end one step at an event


class Plan(NamedTuple):
    """Times (s) a step must end at, the longest step (s) before each, the time between samples (s), the step budget."""

    stops: np.ndarray
    caps: np.ndarray
    interval: float
    maximum_steps: int


class Loop(NamedTuple):
    """What evolves: states at the ends of the last step, its stages, surveys of its ends, faces on the rail, clock and counts."""

    start: np.ndarray
    end: np.ndarray
    stages: np.ndarray
    before: np.ndarray
    after: np.ndarray
    engaged: np.ndarray
    clock: np.ndarray
    count: np.ndarray
    work: np.ndarray


def ready(state: np.ndarray, faces: int, first_step: float) -> Loop:
    """A loop about to take its first sample at ``state`` (STATE_SIZE,)."""
    clock, count = np.zeros(11), np.zeros(6, dtype=np.int64)
    clock[WANTED], clock[LIMIT], count[SEGMENT] = first_step, np.inf, -1
    clock[FRICTION_POWER] = clock[DAMPING_POWER] = -np.inf
    return Loop(state.copy(), state.copy(), np.zeros((STAGES, slot.STATE_SIZE)), np.zeros((faces, SURVEY_SIZE)),
                np.zeros((faces, SURVEY_SIZE)), np.zeros(faces, dtype=np.bool_), clock, count, np.zeros(slot.STATE_SIZE))


@njit
def march(model, plan, tolerance, loop, last, rows, forces):
    """Take samples up to number ``last`` into ``rows`` (n, SAMPLE_SIZE) and ``forces`` (n, f, 3); says why it stopped."""
    clock = loop.clock
    if loop.count[TAKEN] == 0:
        survey(model.contact, model.faces, model.platform, model.payload, loop.engaged, loop.end, loop.after)
        on_rail(model.contact, model.rail_start, model.rail_end, loop.after, loop.engaged)
    for number in range(loop.count[TAKEN], last + 1):
        time = number * plan.interval
        while clock[NOW] < time:
            if loop.count[STEPS] >= plan.maximum_steps:
                return OUT_OF_STEPS
            if not step(model, plan, tolerance, loop):
                return UNDERFLOW
        if time == clock[NOW]:
            loop.work[:] = loop.end
        else:
            interpolate(clock[SIZE], (time - clock[BEGAN]) / clock[SIZE], loop.start, loop.stages, slot.STATE_SIZE, loop.work)
        observe(model, loop.engaged, loop.work, rows[number], forces[number])
        if not (np.isfinite(rows[number]).all() and np.isfinite(forces[number]).all()):
            return NOT_FINITE
        loop.count[TAKEN] += 1
    return SAMPLED


@njit
def step(model, plan, tolerance, loop):
    """Take one step; False when none is short enough."""
    clock, count = loop.clock, loop.count
    _begin(model, plan, loop)
    stop, rate = plan.stops[count[SEGMENT]], clock[RATE]
    ceiling, landings = min(plan.caps[count[SEGMENT]], STABLE_RADIUS / rate), 0
    while True:
        dt = min(clock[WANTED], ceiling)
        reaches = clock[BEGAN] + dt * (1.0 + 1e-9) >= stop
        dt = stop - clock[BEGAN] if reaches else dt
        if clock[BEGAN] + dt == clock[BEGAN] or not dt > 1e-25:
            return False
        attempt(model, loop.engaged, clock[FIRST], clock[LAST], clock[BEGAN], dt, loop.start, loop.stages, loop.end)
        count[EVALUATIONS] += STAGES - 1
        ratio = error_ratio(tolerance, model.payload, model.platform, dt, loop.stages, loop.end, loop.work)
        if not ratio <= 1.0:
            count[REJECTED] += 1
            clock[WANTED] = dt * (max(_SHRINK, _SAFETY * ratio**-0.2) if ratio < np.inf else _SHRINK)
            continue
        touching = survey(model.contact, model.faces, model.platform, model.payload, loop.engaged, loop.end, loop.after)
        clock[RATE] = _rate(model, loop) if touching else 0.0
        limit = STABLE_RADIUS / max(rate, clock[RATE])
        if dt > limit * (1.0 + 1e-12):
            count[REJECTED] += 1
            clock[WANTED] = _SAFETY * limit
            continue
        theta = first_event(model.contact, model, loop.engaged, loop.before, loop.after, dt, loop.start, loop.stages, loop.work)
        if theta < 1.0 - 1e-9 and landings < _LANDINGS:
            landings += 1
            ceiling = theta * dt
            continue
        _accept(loop, dt, stop if reaches else clock[BEGAN] + dt, ratio, limit, landings)
        return True


@njit
def _rate(model, loop):
    return fastest_rate(model.contact, model.friction, model.faces, model.platform, model.payload, loop.engaged, loop.end)


@njit
def _begin(model, plan, loop):
    """Make the end of the last step the start of the next; what jumps in between jumps here."""
    clock, count = loop.clock, loop.count
    loop.start[:] = loop.end
    clock[BEGAN] = clock[NOW]
    corner = count[SEGMENT] < 0 or clock[NOW] >= plan.stops[count[SEGMENT]]
    changed, energy = on_rail(model.contact, model.rail_start, model.rail_end, loop.after, loop.engaged)
    loop.start[slot.RELEASED] += energy
    if corner:
        count[SEGMENT] += 1
        clock[FIRST], clock[LAST] = np.nextafter(clock[NOW], np.inf), np.nextafter(plan.stops[count[SEGMENT]], -np.inf)
    if corner or changed:
        survey(model.contact, model.faces, model.platform, model.payload, loop.engaged, loop.start, loop.after)
        derivative(model, loop.engaged, max(clock[NOW], clock[FIRST]), loop.start, loop.stages[0])
        clock[RATE] = _rate(model, loop)
        count[EVALUATIONS] += 1
    else:
        loop.stages[0] = loop.stages[STAGES - 1]
    loop.before[:] = loop.after


@njit
def _accept(loop, dt, time, ratio, limit, landings):
    clock, count = loop.clock, loop.count
    grown = dt * (min(_GROW, _SAFETY * ratio**-0.2) if ratio > 0.0 else _GROW)
    # A step cut short by an event or a corner says little about the next one.
    clock[WANTED] = grown if dt >= clock[WANTED] else max(grown, clock[WANTED])
    clock[NOW], clock[SIZE] = time, dt
    clock[LIMIT], clock[LIMIT_USED] = min(clock[LIMIT], limit), max(clock[LIMIT_USED], dt / limit)
    clock[FRICTION_POWER] = max(clock[FRICTION_POWER], -loop.stages[STAGES - 1, slot.FRICTION])
    clock[DAMPING_POWER] = max(clock[DAMPING_POWER], -loop.stages[STAGES - 1, slot.DAMPING])
    count[STEPS] += 1
    count[EVENTS] += landings
