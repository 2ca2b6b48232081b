"""The time loop: steps from event to event, and samples on a separate grid."""

import numpy as np

from tipoff.kernels.jit import entry, kernel
from tipoff.lowfi import pushers
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.stick_slip import clear
from tipoff.lowfi.contact.wall_ends import DEPTH
from tipoff.lowfi.dynamics import audit, ending, stick_slip
from tipoff.lowfi.dynamics.cases import BOOK, LEFT_OPEN, STEPS, system_of
from tipoff.lowfi.dynamics.dormand_prince import interpolate
from tipoff.lowfi.dynamics.local_error import with_reach
from tipoff.lowfi.dynamics.loop import Loop, allocate
from tipoff.lowfi.dynamics.sample import follow_loads, observe
from tipoff.lowfi.dynamics.step import step
from tipoff.lowfi.dynamics.survey import survey, update_engaged
from tipoff.lowfi.dynamics.vibration import follow_neglected, reset_neglected
from tipoff.mechanics import books

# Results of ``integrate``: all samples taken; exit, settled window and jam known; or the reason of
# an earlier stop.
SAMPLED, ENDED, UNDERFLOW, OUT_OF_STEPS, NOT_FINITE, STRUCK, LOST_ENERGY = range(7)
NOT_BEGUN = -1  # instead of the number of samples


def ready(system, state: np.ndarray, first_step: float) -> Loop:
    """A loop of ``system`` that ``integrate`` begins at ``state`` (STATE_SIZE,) with a first step of
    ``first_step`` (s). Rails are at rest, or have the modes at the end of ``state``."""
    loop = allocate(system)
    loop.start[: state.size] = state
    loop.clock.wanted, loop.counts.samples = first_step, NOT_BEGUN
    return loop


@kernel
def reset(system, state, first_step, loop):
    """Reset a used loop to the start of a run."""
    loop.start[:] = 0.0
    slot.copy(state, loop.start, state.size)
    _begin(system, first_step, loop)


@kernel
def _begin(system, first_step, loop):
    """Begin a run at ``loop.start``."""
    _reset_clock(loop.clock, first_step)
    _reset_counts(loop.counts)
    loop.counts.apart = not system.platform.free
    _reset_audit(loop.audit)
    slot.copy(loop.start, loop.end, loop.start.size)
    _reset_compliance(system.compliance, system.friction)
    reset_neglected(system.neglected)
    loop.engaged[:] = False
    loop.depth_left[:] = 0.0
    loop.touching[:] = False
    loop.stages[:] = 0.0
    loop.before[:] = 0.0
    loop.after[:] = 0.0
    books.reset(loop.book)
    _reset_stick(loop.stick)
    survey(system, loop, solved=False)
    pushers.reset(system.pushing)
    update_engaged(system, loop)  # pads may press from the start
    stick_slip.update(system.contact, system, loop)


@kernel
def _reset_clock(clock, first_step):
    clock.began = clock.now = clock.dt = clock.rate = clock.growth = clock.limit_used = 0.0
    clock.wanted, clock.limit, clock.kept = first_step, np.inf, 1.0
    clock.friction_power = clock.damping_power = -np.inf


@kernel
def _reset_counts(counts):
    counts.steps = counts.rejected = counts.events = counts.evaluations = counts.samples = 0
    counts.segment = counts.striking_face = -1


@kernel
def _reset_audit(audit):
    audit.first = audit.error = audit.peak_error = audit.scale = 0.0
    audit.first_transverse = audit.error_transverse = 0.0
    audit.peak_error_transverse = audit.scale_transverse = 0.0
    audit.terms = audit.dissipated = audit.created = audit.in_compliance = 0.0
    audit.failed = False


@kernel
def _reset_compliance(compliance, friction):
    """Reset the displacement of the last run, and its change with the pads, and take the friction of
    this one."""
    if compliance is not None:
        _take_friction(compliance.workspace, friction)
        compliance.workspace.displacement[:] = 0.0
        compliance.workspace.yielding[:] = 0.0


@kernel
def _take_friction(workspace, friction):
    workspace.friction[0] = friction.dynamic


@kernel
def _reset_stick(stick):
    for i in range(stick.shape[0]):
        clear(stick[i])


@entry
def integrate(common, plan, tolerance, marks, loop, cases, sampling):
    """Run ``cases`` of the ``common`` system. With samples, there is one case: it continues from
    the state of ``loop`` up to sample ``sampling.number``, or begins if the loop is ready; the
    result is the reason of its stop. Without samples, each case runs from its start until exit and
    jam are known or the scene ends, and fills its row of ``cases.results``."""
    status = SAMPLED
    for n in range(cases.mass.size):
        system = system_of(common, cases, n)
        if sampling.number < 0:
            reset(system, cases.start[n], plan.first, loop)
        elif loop.counts.samples == NOT_BEGUN:
            _begin(system, loop.clock.wanted, loop)
        open_ = sampling.number < 0 and _presses(loop)
        if not open_:
            allowed = with_reach(tolerance, cases.reach[n])
            status = _integrate(system, plan, allowed, marks, loop, sampling)
        if sampling.number < 0:
            _note(cases.results[n], loop, tolerance, open_ or status != ENDED)
    return status


@kernel
def _note(result, loop, tolerance, left_open):
    """Fill the ``result`` (RESULT_SIZE,) of a case. A case whose ledgers need smaller steps is left
    open."""
    affordable = audit.usage(loop.audit, tolerance.total, tolerance.transverse) <= 1.0
    result[LEFT_OPEN] = 1.0 if left_open or not affordable else 0.0
    result[STEPS] = loop.counts.steps
    slot.copy(loop.book, result[BOOK:], books.BOOK_SIZE)


@kernel
def _presses(loop):
    for i in range(loop.engaged.size):
        if loop.engaged[i] and loop.after[i, DEPTH] > 0.0:
            return True
    return False


@kernel
def _integrate(system, plan, tolerance, marks, loop, sampling):
    """Take samples up to ``sampling.number``, and after the last one continue to the end of the
    scene; fewer if the settled window is complete or a jam is found. The steps end at the same time
    for any sampling."""
    clock, counts, end, ended = (
        loop.clock,
        loop.counts,
        plan.stops[-1],
        sampling.number == sampling.last,
    )
    for taken in range(counts.samples, sampling.number + 1):
        time = min(taken * sampling.interval, end)
        status = _reach(system, plan, tolerance, marks, loop, sampling, time)
        if status == ENDED or (
            not sampling.whole and books.is_left_out(loop.book, time, sampling.interval)
        ):
            ended = True
            break
        if status != SAMPLED:
            return status
        if time == clock.now:
            slot.copy_all(loop.end, loop.work, slot.modal_size(system.compliance))
        else:
            theta = (time - clock.began) / clock.dt
            interpolate(system, loop, clock.dt, theta, slot.STATE_SIZE, loop.work)
        if not observe(system, loop, sampling.rows[taken], sampling.forces[taken]):
            return NOT_FINITE
        counts.samples += 1
    if not ended:
        return SAMPLED
    status = _reach(system, plan, tolerance, marks, loop, sampling, end)
    return ENDED if status == SAMPLED else status


@kernel
def _reach(system, plan, tolerance, marks, loop, sampling, time):
    """Step until ``time`` (s): SAMPLED, or the reason why it is not reached."""
    while loop.clock.now < time:
        if not sampling.whole and books.is_over(loop.book, loop.clock.now):
            return ENDED
        status = advance(system, plan, tolerance, marks, loop)
        if status != SAMPLED:
            return status
        follow_loads(system, loop, sampling.loads)
    return SAMPLED


@kernel
def advance(system, plan, tolerance, marks, loop):
    """Take one step and update the book of exit and jam: SAMPLED, or the reason why there is no
    step."""
    if loop.counts.steps >= plan.maximum_steps:
        return OUT_OF_STEPS
    if not step(system, plan, tolerance, loop):
        if loop.counts.striking_face >= 0:
            return STRUCK
        return LOST_ENERGY if loop.audit.failed else UNDERFLOW
    if not _has_finite_energy(loop.end, slot.modal_size(system.compliance)):
        return NOT_FINITE
    clock = loop.clock
    follow_neglected(system.neglected, system, loop)
    ending.follow(system, marks, loop, ending.Step(clock.began, clock.now, clock.dt))
    return SAMPLED


@kernel
def _has_finite_energy(state, modal):
    """Whether the squares of all speeds, and all other values, are finite."""
    total = 0.0
    for j in range(slot.DYNAMIC_SIZE):
        total += state[j] * state[j]
    for j in range(slot.STATE_SIZE, slot.STATE_SIZE + modal):
        total += state[j] * state[j]
    return np.isfinite(total)
