"""One step of the time loop. Error control, events, the proven limit and the energy ledgers
limit its length."""

import math

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi import pushers
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant.step_limit import stiffness_and_damping
from tipoff.lowfi.contact.compliant.survey import energy as energy_in_compliance
from tipoff.lowfi.contact.compliant.survey import longest_step_at_ends
from tipoff.lowfi.contact.step_limit import fastest_rate
from tipoff.lowfi.contact.wall_ends import SOONEST, SURVEY_SIZE
from tipoff.lowfi.dynamics import audit, stick_slip
from tipoff.lowfi.dynamics.dormand_prince import STABLE_RADIUS, STAGES, attempt, interpolate
from tipoff.lowfi.dynamics.events import first_event
from tipoff.lowfi.dynamics.local_error import error_ratio
from tipoff.lowfi.dynamics.survey import keeps_law, survey, update_engaged, update_touching
from tipoff.lowfi.dynamics.vibration import longest_step, shortened
from tipoff.mechanics.books import EXIT

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 5.0
# Steps that error control proposes are powers of 2^(1/16). Error estimates of steps in which cells
# begin to press depend strongly on the step. If the next step followed them continuously, a
# rounding difference, for example from the order of the pads, would grow with each step up to the
# tolerance. The next lower power takes 2 % more steps.
_RUNGS = 2.0 ** (np.arange(16) / 16.0 - 1.0)
# Largest error ratio at which interpolation may cut a step; the error at the cut is several times
# larger.
_SPARE = 0.1
# A change of law in this last share of a step does not cut it: the error is of second order in the
# share, as in the energy of a pad that springs back freely in one step.
_NEAR_END = 1e-4
# While a pad presses on, the bound of its contact grows from step to step. A step at the limit of its
# start would then be refused at its end. Twice the last growth is expected, up to a tenth.
_GROWTHS, _MOST_GROWTH = 2.0, 0.1
_CUTS = 40  # of one step
# Attempts for one step for the sake of the ledgers; an error that remains does not depend on the
# step size.
_HALVINGS = 6


@kernel
def step(system, plan, tolerance, loop):
    """Take one step; False if no step is short enough, if it lost a tenth of the energy, or if a
    face strikes an edge of its wall at the start of the step."""
    clock, counts = loop.clock, loop.counts
    fresh = _begin(system, plan, loop)
    if counts.striking_face >= 0:
        return False
    start, segment = clock.began, counts.segment
    stop, rate, cuts, halvings = plan.stops[segment], clock.rate, 0, 0
    # At a corner, the thrust of the side from which it is reached.
    stretch = (
        np.nextafter(0.0 if segment == 0 else plan.stops[segment - 1], np.inf),
        np.nextafter(stop, -np.inf),
    )
    ceiling = min(
        clock.wanted,
        plan.caps[segment],
        STABLE_RADIUS / (rate * (1.0 + _expected_growth(system.is_compliant, clock))),
        stop - start,
        _longest_at_ends(system.is_compliant, system, loop),
        longest_step(system.compliance, loop.touching, loop.engaged, loop.before, loop.start),
    )
    ceiling = _within_predicted_limit(system, loop, ceiling)
    while True:
        clock.wanted = _rung(clock.wanted)
        dt = min(clock.wanted, ceiling)
        reaches = start + dt * (1.0 + 1e-9) >= stop
        dt = stop - start if reaches else dt
        if start + dt == start or not dt > 0.0:
            return False
        attempt(system, loop, stretch, start, dt, fresh)
        counts.evaluations += STAGES if fresh else STAGES - 1
        fresh = False
        ratio = error_ratio(tolerance, system, loop, dt)
        if not ratio <= 1.0:
            counts.rejected += 1
            clock.wanted = dt * (max(_SHRINK, _SAFETY * ratio**-0.2) if ratio < np.inf else _SHRINK)
            continue
        clock.rate = rate_bound(system, loop, loop.end, solved=True)  # by the last stage
        limit = STABLE_RADIUS / max(rate, clock.rate)
        if dt > limit * (1.0 + 1e-12):
            counts.rejected += 1
            clock.wanted = _SAFETY * limit
            continue
        survey(system, loop, solved=True)
        shorter = _within_reach_of_vibration(system, loop, dt)
        if shorter < dt:
            ceiling = shorter
            continue
        smooth = ratio <= _SPARE and keeps_law(loop)
        span, face = _cut_at_event(system, loop, dt)
        if face >= 0:  # touches as the step begins, by rounding on the wrong side
            loop.touching[face] = fresh = True
            stick_slip.begin_contact(system.contact, system, loop, face)
            continue
        if span < 1.0 and not smooth and not (cuts > 0 and span > 1.0 - _NEAR_END) and cuts < _CUTS:
            cuts, ceiling = cuts + 1, span * dt * (1.0 + 0.2 * _NEAR_END)
            continue
        balances = audit.after_step(system, loop)
        if halvings < _HALVINGS and not audit.step_is_affordable(system, tolerance, loop, balances):
            halvings += 1
            counts.rejected += 1
            clock.wanted = 0.5 * span * dt
            continue
        clock.kept = span
        clock.growth = clock.rate / rate - 1.0 if rate > 0.0 else 0.0
        if span < 1.0:
            _accept_part(loop, dt, start + span * dt, limit)
        else:
            _accept(loop, dt, stop if reaches else start + dt, ratio, limit)
        return audit.record_step(system, tolerance, loop, balances)


@kernel
def _expected_growth(is_compliant, clock):
    """Relative growth of the bound of compliant contact that the next step allows for. That of springs
    is found in advance (``_within_predicted_limit``)."""
    growth = 0.0
    if is_compliant is not None:
        growth = min(_GROWTHS * max(clock.growth, 0.0), _MOST_GROWTH)
    return growth


@kernel
def _rung(dt):
    """The largest power of 2^(1/16) that is not above ``dt`` (s), to rounding."""
    if not 0.0 < dt < np.inf:
        return dt
    mantissa, exponent = math.frexp(dt)
    rung = _RUNGS[0]
    for power in _RUNGS:
        if power <= mantissa * (1.0 + 1e-7):
            rung = power
    return math.ldexp(rung, exponent)


@kernel
def _begin(system, plan, loop):
    """Make the end of the last step the start of the next, and apply the jumps in between. True if
    the derivative jumps too."""
    clock, counts = loop.clock, loop.counts
    slot.copy_all(loop.end, loop.start, slot.modal_size(system.compliance))
    clock.began = clock.now
    fresh = counts.segment < 0 or clock.now >= plan.stops[counts.segment]
    if fresh:
        counts.segment += 1
    left, energy, returned, counts.striking_face = update_engaged(system, loop)
    loop.start[slot.RELEASED] += energy
    loop.audit.dissipated -= returned
    changed, lost = stick_slip.update(system.contact, system, loop)
    loop.start[slot.FRICTION] += lost
    for i in range(loop.engaged.size):
        slot.copy(loop.after[i], loop.before[i], SURVEY_SIZE)
    slot.copy_all(loop.stages[STAGES - 1], loop.stages[0], slot.modal_size(system.compliance))
    _release(system.is_compliant, system, loop, left, 1.0)
    changed = update_touching(loop) or changed
    changed = pushers.begin_step(system.pushing) or changed
    changed = (system.pushing.segment.size > 0 and counts.steps == 0) or changed
    if changed:
        clock.rate = rate_bound(system, loop, loop.start, solved=False)
    _release(system.is_compliant, system, loop, left, -1.0)
    if counts.steps == 0:
        audit.open_books(system.is_compliant, system, loop)
    parted = _part(system, loop)
    return changed or left or fresh or parted or clock.kept < 1.0


@kernel
def _part(system, loop):
    """After the exit, refer A of both bodies to their own mass centres; True in that step."""
    parts = loop.book[EXIT] < np.inf and not loop.counts.apart
    if parts:
        loop.counts.apart = True
        slot.take_apart(system.payload.mass, loop.start, slot.PAYLOAD)
        if system.platform.free:
            slot.take_apart(system.platform.mass, loop.start, slot.PLATFORM)
    return parts


@kernel
def _release(is_compliant, system, loop, left, sign):
    """Count as released the energy in compliant contact that leaving faces remove: called before
    they leave with ``sign`` 1, and after with -1."""
    if is_compliant is not None:
        if left:
            loop.start[slot.RELEASED] += sign * energy_in_compliance(
                system.compliance,
                system.faces,
                system.platform,
                system.payload,
                loop.touching,
                loop.start,
            )


@kernel
def _longest_at_ends(is_compliant, system, loop):
    longest = np.inf
    if is_compliant is not None:
        longest = longest_step_at_ends(
            system.compliance,
            system.faces,
            system.platform,
            system.payload,
            loop.touching,
            loop.start,
        )
    return longest


@kernel
def _within_reach_of_vibration(system, loop, dt):
    """``dt`` (s), or a shorter step before which no face comes within reach of a vibrating wall."""
    return shortened(
        system.compliance,
        loop.touching,
        loop.engaged,
        loop.before,
        loop.after,
        loop.start,
        dt,
    )


@kernel
def _within_predicted_limit(system, loop, dt):
    """``dt`` (s), or less if the proven limit of springs is expected to fall below it by the end of
    the step: an estimate that saves attempts."""
    touching = False
    for touches in loop.touching:
        touching = touching or touches
    while touching:
        limit = STABLE_RADIUS / fastest_rate(
            system.contact, system, loop.touching, loop.stick, loop.start, 0.7 * dt
        )
        touching = dt > limit
        dt = max(0.7 * dt, limit) if touching else dt
    return dt


@kernel
def rate_bound(system, loop, state, solved):
    """Bound (1/s) of the eigenvalues of contact and pushers at ``state``; ``solved``: compliant contact is
    already solved there."""
    rate = fastest_rate(system.contact, system, loop.touching, loop.stick, state, 0.0)
    rate = max(rate, _rate_on_compliance(system.is_compliant, system, loop, state, solved))
    # The bound of a sum of stiffnesses and dampings is at most the sum of the bounds.
    return rate + pushers.fastest_rate(system.pushing, system.platform, system.payload, state)


@kernel
def _rate_on_compliance(is_compliant, system, loop, state, solved):
    rate = 0.0
    if is_compliant is not None:
        stiffness, damping = stiffness_and_damping(
            system.compliance,
            system.friction,
            system.faces,
            system.platform,
            system.payload,
            loop.touching,
            state,
            solved,
        )
        rate = 0.5 * damping + np.sqrt(0.25 * damping * damping + stiffness)
    return rate


@kernel
def _cut_at_event(system, loop, dt):
    """Cut the step at its first event: returns the kept fraction, with ``loop.end`` and its survey
    there, or a face that touches from the start."""
    span, began = 1.0, loop.clock.began
    for _ in range(_CUTS):
        theta, face = first_event(system, loop, dt, span)
        if theta >= 1.0 - 1e-9:
            return span, -1
        if theta * span <= SOONEST or began + 0.01 * theta * span * dt == began:
            return span, -1 if loop.touching[face] or not loop.engaged[face] else face
        span *= theta
        loop.counts.events += 1
        interpolate(system, loop, dt, span, slot.STATE_SIZE, loop.end)
        survey(system, loop, solved=False)
    return span, -1


@kernel
def _accept(loop, dt, time, ratio, limit):
    clock, derivative = loop.clock, loop.stages[STAGES - 1]
    grown = dt * (min(_GROW, _SAFETY * ratio**-0.2) if ratio > 0.0 else _GROW)
    # A step cut short by a corner gives little information on the next one.
    clock.wanted = grown if dt >= clock.wanted else max(grown, clock.wanted)
    clock.friction_power = max(clock.friction_power, -derivative[slot.FRICTION])
    clock.damping_power = max(clock.damping_power, -derivative[slot.DAMPING])
    _accept_part(loop, dt, time, limit)


@kernel
def _accept_part(loop, dt, time, limit):
    clock = loop.clock
    clock.now, clock.dt = time, dt
    clock.limit, clock.limit_used = min(clock.limit, limit), max(clock.limit_used, dt / limit)
    loop.counts.steps += 1
