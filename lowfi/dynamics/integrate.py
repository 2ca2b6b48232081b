"""The time loop: steps as long as error, events and the proven limit allow, samples on their own
grid in between."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import inlined, kernel
from tipoff.kernels.memory import zeros
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant.record import states
from tipoff.lowfi.contact.compliant.step_limit import stiffness_and_damping
from tipoff.lowfi.contact.compliant.survey import energy as energy_on_walls
from tipoff.lowfi.contact.compliant.survey import while_hanging
from tipoff.lowfi.contact.step_limit import fastest_rate
from tipoff.lowfi.contact.stick_slip import GRIP_SIZE, let_go
from tipoff.lowfi.contact.wall_ends import SOONEST, SURVEY_SIZE
from tipoff.lowfi.dynamics import audit, ending
from tipoff.lowfi.dynamics.dormand_prince import STABLE_RADIUS, STAGES, attempt, interpolate
from tipoff.lowfi.dynamics.events import felt, first_event, on_rail, same_law, survey
from tipoff.lowfi.dynamics.local_error import error_ratio
from tipoff.lowfi.dynamics.sample import observe
from tipoff.lowfi.dynamics.stick_slip import grasp, regrip
from tipoff.mechanics import ending as books

# What ``march`` returns: all samples taken, nothing left to learn, or why it stopped before.
SAMPLED, ENDED, UNDERFLOW, OUT_OF_STEPS, NOT_FINITE, STRUCK, LOST_ENERGY = range(7)
# Slots of Loop.clock: ends of the last step and its size before an event cut it (s), the fraction
# kept, step the controller wants (s), bound of the contact's rates at the end (1/s), smallest
# proven limit met (s), largest step over its limit (1), largest friction and damping power (W, not
# above zero).
(
    BEGAN,
    NOW,
    SIZE,
    SPAN,
    WANTED,
    RATE,
    LIMIT,
    LIMIT_USED,
    FRICTION_POWER,
    DAMPING_POWER,
    CLOCK_SIZE,
) = range(11)
# Slots of Loop.count; STRIKING is the face that struck an edge of its wall, or -1.
SEGMENT, STEPS, REJECTED, EVENTS, EVALUATIONS, TAKEN, STRIKING, COUNT_SIZE = range(8)
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 5.0
# largest error ratio at which a step may be cut by interpolation, whose error is some times larger
_SPARE = 0.1
# Last share of a step in which a change of law cannot be felt: its effect goes with the square. Of
# the energy of a pad that springs back freely in one step the ledger misses the square of it.
_NEAR_END = 1e-4
_LANDINGS = 40  # cuts of one step
# of one step for the sake of the ledgers: what is off still is not a matter of its length
_HALVINGS = 6


class Plan(NamedTuple):
    """Times (s) a step must end at, the last one the end of the scene, the longest step (s) before
    each, the step budget."""

    stops: np.ndarray
    caps: np.ndarray
    maximum_steps: int


class Sampling(NamedTuple):
    """Time between samples (s), number of the last one in the scene, number of the one to stop at,
    and whether the run goes on although nothing is left to learn."""

    interval: float
    last: int
    number: int
    whole: bool


class Loop(NamedTuple):
    """What evolves: states at the ends of the last step, its stages, surveys of its ends, faces
    that stand over their walls, penetrations (m) with which those left that are partly over them
    still, faces felt in the last step and their grips in it (None where friction does not stick),
    clock and counts, the book of exit, settled window and jam (``mechanics.ending``), and the ledgers
    (``lowfi.dynamics.audit``)."""

    start: np.ndarray
    end: np.ndarray
    stages: np.ndarray
    before: np.ndarray
    after: np.ndarray
    engaged: np.ndarray
    left: np.ndarray
    active: np.ndarray
    grip: np.ndarray | None
    clock: np.ndarray
    count: np.ndarray  # type: ignore[assignment]  # tuple.count, which nobody calls
    work: np.ndarray
    book: np.ndarray
    audit: np.ndarray


def ready(system, state: np.ndarray, first_step: float) -> Loop:
    """A loop about to take its first sample of ``system`` at ``state`` (STATE_SIZE,), and its first
    step of ``first_step`` (s). Rails are at rest, or as modes at the end of ``state`` say."""
    faces, size = system.faces.shape[0], slot.STATE_SIZE + states(system.compliance)
    state_, survey_ = (size,), (faces, SURVEY_SIZE)
    grip = zeros((faces, GRIP_SIZE)) if system.sticking is not None else None
    loop = Loop(
        zeros(state_),
        zeros(state_),
        zeros((STAGES, size)),
        zeros(survey_),
        zeros(survey_),
        np.zeros(faces, dtype=np.bool_),
        zeros((faces,)),
        np.zeros(faces, dtype=np.bool_),
        grip,
        zeros((CLOCK_SIZE,)),
        np.zeros(COUNT_SIZE, dtype=np.int64),
        zeros(state_),
        zeros((books.BOOK_SIZE,)),
        zeros((audit.AUDIT_SIZE,)),
    )
    reset(system, state, first_step, loop)
    return loop


@kernel
def reset(system, state, first_step, loop):
    """Bring a loop of any past to the begin of a run."""
    clock, count = loop.clock, loop.count
    clock[:] = 0.0
    count[:] = 0
    clock[WANTED], clock[LIMIT], clock[SPAN], count[SEGMENT] = first_step, np.inf, 1.0, -1
    clock[FRICTION_POWER] = clock[DAMPING_POWER] = -np.inf
    loop.audit[:] = 0.0
    loop.start[:] = 0.0
    loop.end[:] = 0.0
    slot.copy(state, loop.start, state.size)
    slot.copy(state, loop.end, state.size)
    _flatten(system.compliance)
    loop.engaged[:] = False
    loop.left[:] = 0.0
    loop.active[:] = False
    loop.stages[:] = 0.0
    loop.before[:] = 0.0
    loop.after[:] = 0.0
    books.reset(loop.book)
    _let_go(loop.grip)
    _survey(system, loop)
    _on_rail(system, loop)
    count[STRIKING] = -1  # pads may press from the start
    _regrip(system, loop)


@inlined
def _flatten(compliance):
    """Forget the displacement that the walls had last."""
    if compliance is not None:
        compliance.room.displacement[:] = 0.0


@inlined
def _on_rail(system, loop):
    """Whether faces came over their walls or left them, the energy (J) that went with them, and
    what came back of it."""
    rail = (system.rail_start, system.rail_end)
    left, energy, returned, loop.count[STRIKING] = on_rail(
        system.contact, system.compliance, rail, system.faces, loop.after, loop.left, loop.engaged
    )
    return left, energy, returned


@inlined
def _let_go(grip):
    if grip is not None:
        for i in range(grip.shape[0]):
            let_go(grip[i])


@inlined
def _survey(system, loop):
    loop.audit[audit.ON_WALLS] = survey(
        system.contact,
        system.compliance,
        system.sticking,
        system.faces,
        system.platform,
        system.payload,
        loop.active,
        loop.grip,
        loop.end,
        loop.after,
    )


@inlined
def _regrip(system, loop):
    """As the step after ``loop.end`` begins."""
    return regrip(
        system.contact,
        system.sticking,
        system.payload,
        system.platform,
        system.faces,
        loop.engaged,
        loop.active,
        loop.grip,
        loop.before,
        loop.after,
        loop.end,
    )


@inlined
def _fastest_rate(system, loop, state, ahead):
    rate = fastest_rate(
        system.contact,
        system.friction,
        system.sticking,
        system.faces,
        system.platform,
        system.payload,
        loop.active,
        loop.grip,
        state,
        ahead,
    )
    return max(rate, _rate_on_walls(system.compliance, system, loop, state))


@inlined
def _rate_on_walls(compliance, system, loop, state):
    rate = 0.0
    if compliance is not None:
        stiffness, damping = stiffness_and_damping(
            compliance,
            system.friction,
            system.faces,
            system.platform,
            system.payload,
            loop.active,
            state,
        )
        rate = 0.5 * damping + np.sqrt(0.25 * damping * damping + stiffness)
    return rate


@kernel
def march(system, plan, tolerance, marks, loop, sampling, rows, forces):
    """Take samples up to ``sampling.number`` into ``rows`` (n, SAMPLE_SIZE) and ``forces`` (n, f,
    3), and after the last one go on to the scene's end; or less, when nothing is left to learn of
    the settled window or of a jam: the steps end then at the same instant, whatever is sampled."""
    clock, count, end, ended = (
        loop.clock,
        loop.count,
        plan.stops[-1],
        sampling.number == sampling.last,
    )
    for taken in range(count[TAKEN], sampling.number + 1):
        time = min(taken * sampling.interval, end)
        status = _reach(system, plan, tolerance, marks, loop, sampling.whole, time)
        if status == ENDED or (
            not sampling.whole and books.is_left_out(loop.book, time, sampling.interval)
        ):
            ended = True
            break
        if status != SAMPLED:
            return status
        if time == clock[NOW]:
            slot.copy_all(loop.end, loop.work, slot.modal_size(system.compliance))
        else:
            interpolate(
                clock[SIZE],
                (time - clock[BEGAN]) / clock[SIZE],
                loop.start,
                loop.stages,
                slot.STATE_SIZE,
                slot.modal_size(system.compliance),
                loop.work,
            )
        # Before the first step nothing is felt yet, and every face may press.
        felt_ = loop.active if count[STEPS] > 0 else loop.engaged
        if not observe(
            system, loop.engaged, felt_, loop.grip, loop.work, rows[taken], forces[taken]
        ):
            return NOT_FINITE
        count[TAKEN] += 1
    if not ended:
        return SAMPLED
    status = _reach(system, plan, tolerance, marks, loop, sampling.whole, end)
    return ENDED if status == SAMPLED else status


@inlined
def _reach(system, plan, tolerance, marks, loop, whole, time):
    """Step until ``time`` (s) is reached: SAMPLED, or why it is not."""
    while loop.clock[NOW] < time:
        if not whole and books.is_over(loop.book, loop.clock[NOW]):
            return ENDED
        status = advance(system, plan, tolerance, marks, loop)
        if status != SAMPLED:
            return status
    return SAMPLED


@kernel
def advance(system, plan, tolerance, marks, loop):
    """Take one step and enter into the book what it tells: SAMPLED, or why there is none."""
    clock = loop.clock
    if loop.count[STEPS] >= plan.maximum_steps:
        return OUT_OF_STEPS
    if not step(system, plan, tolerance, loop):
        return (
            STRUCK
            if loop.count[STRIKING] >= 0
            else UNDERFLOW
            if loop.audit[audit.LOST] == 0.0
            else LOST_ENERGY
        )
    if not _has_finite_energy(loop.end, slot.modal_size(system.compliance)):
        return NOT_FINITE
    ending.follow(system, marks, loop, ending.Step(clock[BEGAN], clock[NOW], clock[SIZE]))
    return SAMPLED


@inlined
def _has_finite_energy(state, modal):
    """Whether speeds have squares that are still numbers, and all else is one."""
    total = 0.0
    for j in range(slot.DYNAMIC_SIZE):
        total += state[j] * state[j]
    for j in range(slot.STATE_SIZE, slot.STATE_SIZE + modal):
        total += state[j] * state[j]
    return np.isfinite(total)


@kernel
def step(system, plan, tolerance, loop):
    """Take one step; False when none is short enough, when it lost a tenth of the energy, or when a
    face strikes an edge of its wall where the step would begin."""
    clock, count = loop.clock, loop.count
    fresh = _begin(system, plan, loop)
    if count[STRIKING] >= 0:
        return False
    start, segment = clock[BEGAN], count[SEGMENT]
    stop, rate, landings, halvings = plan.stops[segment], clock[RATE], 0, 0
    # At a corner the thrust is the one of the stretch it is seen from.
    stretch = (
        np.nextafter(0.0 if segment == 0 else plan.stops[segment - 1], np.inf),
        np.nextafter(stop, -np.inf),
    )
    ceiling = _foreseen(
        system,
        loop,
        min(
            clock[WANTED],
            plan.caps[segment],
            STABLE_RADIUS / rate,
            stop - start,
            _while_hanging(system.compliance, system, loop),
        ),
    )
    while True:
        dt = min(clock[WANTED], ceiling)
        reaches = start + dt * (1.0 + 1e-9) >= stop
        dt = stop - start if reaches else dt
        if start + dt == start or not dt > 0.0:
            return False
        attempt(
            system,
            loop.active,
            loop.grip,
            stretch,
            start,
            dt,
            fresh,
            loop.start,
            loop.stages,
            loop.end,
        )
        count[EVALUATIONS] += STAGES if fresh else STAGES - 1
        fresh = False
        ratio = error_ratio(
            tolerance,
            system.payload,
            system.platform,
            system.compliance,
            dt,
            loop.stages,
            loop.end,
            loop.work,
        )
        if not ratio <= 1.0:
            count[REJECTED] += 1
            clock[WANTED] = dt * (
                max(_SHRINK, _SAFETY * ratio**-0.2) if ratio < np.inf else _SHRINK
            )
            continue
        clock[RATE] = _fastest_rate(system, loop, loop.end, 0.0)
        limit = STABLE_RADIUS / max(rate, clock[RATE])
        if dt > limit * (1.0 + 1e-12):
            count[REJECTED] += 1
            clock[WANTED] = _SAFETY * limit
            continue
        _survey(system, loop)
        smooth = ratio <= _SPARE and same_law(loop.before, loop.after, loop.active)
        span, face = _land(system, loop, dt)
        if face >= 0:  # it touches as the step begins, by rounding on the wrong side
            loop.active[face] = fresh = True
            grasp(
                system.contact,
                system.sticking,
                system.payload,
                system.platform,
                system.faces,
                loop.grip,
                face,
                loop.start,
            )
            continue
        if (
            span < 1.0
            and not smooth
            and not (landings > 0 and span > 1.0 - _NEAR_END)
            and landings < _LANDINGS
        ):
            landings, ceiling = landings + 1, span * dt * (1.0 + 0.2 * _NEAR_END)
            continue
        balances = audit.after_step(system.ledger, system, loop)
        if halvings < _HALVINGS and not audit.step_is_affordable(system, tolerance, loop, balances):
            halvings += 1
            count[REJECTED] += 1
            clock[WANTED] = 0.5 * span * dt
            continue
        clock[SPAN] = span
        if span < 1.0:
            _accept_part(clock, count, dt, start + span * dt, limit)
        else:
            _accept(
                loop.stages[STAGES - 1],
                clock,
                count,
                dt,
                stop if reaches else start + dt,
                ratio,
                limit,
            )
        return audit.record_step(system, tolerance, loop, balances)


@inlined
def _release(compliance, system, loop, left, sign):
    """Book what faces that ``left`` the walls took with them: the energy in the walls before less
    that after."""
    if compliance is not None:
        if left:
            loop.start[slot.RELEASED] += sign * energy_on_walls(
                compliance, system.faces, system.platform, system.payload, loop.active, loop.start
            )


@inlined
def _while_hanging(compliance, system, loop):
    longest = np.inf
    if compliance is not None:
        longest = while_hanging(
            compliance, system.faces, system.platform, system.payload, loop.active, loop.start
        )
    return longest


@inlined
def _foreseen(system, loop, dt):
    """``dt`` (s), less where the proven limit will certainly have fallen below it when such a step
    ends: a guess that saves attempts."""
    touching = False
    for felt_now in loop.active:
        touching = touching or felt_now
    while touching:
        limit = STABLE_RADIUS / _fastest_rate(system, loop, loop.start, 0.7 * dt)
        touching = dt > limit
        dt = max(0.7 * dt, limit) if touching else dt
    return dt


@inlined
def _land(system, loop, dt):
    """Cut the step at its first event: the fraction kept, with ``loop.end`` and its survey there,
    or a face to be felt from the start."""
    span = 1.0
    for _ in range(_LANDINGS):
        theta, face = first_event(
            system.contact,
            system.compliance,
            system.sticking,
            system.payload,
            system.platform,
            system.faces,
            (system.rail_start, system.rail_end),
            loop.engaged,
            loop.active,
            loop.grip,
            loop.before,
            loop.after,
            dt,
            span,
            loop.start,
            loop.stages,
            loop.work,
        )
        if theta >= 1.0 - 1e-9:
            return span, -1
        if (
            theta * span <= SOONEST
            or loop.clock[BEGAN] + 0.01 * theta * span * dt == loop.clock[BEGAN]
        ):
            return span, -1 if loop.active[face] or not loop.engaged[face] else face
        span *= theta
        loop.count[EVENTS] += 1
        interpolate(
            dt,
            span,
            loop.start,
            loop.stages,
            slot.STATE_SIZE,
            slot.modal_size(system.compliance),
            loop.end,
        )
        _survey(system, loop)
    return span, -1


@inlined
def _begin(system, plan, loop):
    """Make the end of the last step the start of the next; what jumps in between jumps here. True
    when the derivative jumps too."""
    clock, count = loop.clock, loop.count
    slot.copy_all(loop.end, loop.start, slot.modal_size(system.compliance))
    clock[BEGAN] = clock[NOW]
    fresh = count[SEGMENT] < 0 or clock[NOW] >= plan.stops[count[SEGMENT]]
    if fresh:
        count[SEGMENT] += 1
    left, energy, returned = _on_rail(system, loop)
    loop.start[slot.RELEASED] += energy
    loop.audit[audit.LEFT] -= returned
    regripped, lost = _regrip(system, loop)
    loop.start[slot.FRICTION] += lost
    for i in range(loop.engaged.size):
        slot.copy(loop.after[i], loop.before[i], SURVEY_SIZE)
    slot.copy_all(loop.stages[STAGES - 1], loop.stages[0], slot.modal_size(system.compliance))
    _release(system.compliance, system, loop, left, 1.0)
    changed = felt(loop.after, loop.engaged, loop.active) or regripped
    if changed:
        clock[RATE] = _fastest_rate(system, loop, loop.start, 0.0)
    _release(system.compliance, system, loop, left, -1.0)
    if count[STEPS] == 0:
        audit.open_books(system.ledger, system.compliance, system, loop)
    return changed or left or fresh or clock[SPAN] < 1.0


@kernel
def _accept(derivative, clock, count, dt, time, ratio, limit):
    grown = dt * (min(_GROW, _SAFETY * ratio**-0.2) if ratio > 0.0 else _GROW)
    # A step cut short by a corner says little about the next one.
    clock[WANTED] = grown if dt >= clock[WANTED] else max(grown, clock[WANTED])
    clock[FRICTION_POWER] = max(clock[FRICTION_POWER], -derivative[slot.FRICTION])
    clock[DAMPING_POWER] = max(clock[DAMPING_POWER], -derivative[slot.DAMPING])
    _accept_part(clock, count, dt, time, limit)


@kernel
def _accept_part(clock, count, dt, time, limit):
    clock[NOW], clock[SIZE] = time, dt
    clock[LIMIT], clock[LIMIT_USED] = min(clock[LIMIT], limit), max(clock[LIMIT_USED], dt / limit)
    count[STEPS] += 1
