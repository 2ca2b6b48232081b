"""Both ledgers at the end of every step: what they are off by, and how much of that a step may add.

    balance = work - kinetic - strain - stored - losses,     off = balance - balance at ignition

The embedded error of a step does not see energy. Where a face first touches, a law p^e with no
whole exponent has no bounded fifth derivative, and what the estimate takes for the error of the
worse of two methods is that of both; hundreds of touches add up, and all of one sign. So a step in
contact that takes more than a tenth of what is left of the promise is taken again at half its
length. Half of a promise is kept for what samples between the steps are interpolated with.

What contact loses, ``RELEASED`` and ``DAMPING``, never comes back, but for the energy of a face
that leaves over an edge of its wall and comes back there. Whatever else does was made from nothing:
it counts as an error of both ledgers. The two are taken together, because where a force is about to
be cut off some stages of a step count for one and some for the other, with weights of either sign.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip as grips
from tipoff.lowfi.contact.compliant.modes import energies
from tipoff.lowfi.contact.compliant.survey import energy as energy_on_walls
from tipoff.lowfi.contact.springs import pad_point
from tipoff.lowfi.dynamics.events import DEPTH, stored
from tipoff.lowfi.state import PAYLOAD, PLATFORM
from tipoff.mechanics import promises

# Slots: balances at ignition, what they are off by now and at most, scales so far and the size of
# the terms (J); the most that ever left the contacts and the most given back of it (J); whether a
# tenth of the scale is lost; what walls hold where last surveyed (J).
(
    FIRST,
    FIRST_ACROSS,
    OFF,
    OFF_ACROSS,
    WORST,
    WORST_ACROSS,
    SCALE,
    SCALE_ACROSS,
    TERMS,
    LEFT,
    CREATED,
    LOST,
    ON_WALLS,
    AUDIT_SIZE,
) = range(14)
_HALF = 0.5  # of a promise, for the ends of steps
_SHARE, _LEAST = 0.1, 1e-3  # of what is left of it, and of all of it, that one step may take
_LOST = 0.1
_ROUNDING = promises.ROUNDING


@inlined
def balances(system, engaged, grip, surveyed, on_walls, state):
    """Total and transverse balance (J), work, kinetic energy, transverse energy and size of all
    terms at a surveyed ``state``; ``on_walls`` is the energy (J) that walls hold under the felt
    faces."""
    body = slot.motion(system.payload.mass, system.payload.inverse_inertia, state, PAYLOAD)
    base = slot.frame(system.platform, state)
    kinetic, axial = _kinetic(system.payload.mass, state[:PLATFORM], body)
    more, more_axial = _kinetic_of_platform(system.platform, state, base)
    vibrating, strain = _of_modes(system.compliance, state)
    kept = (
        on_walls
        + strain
        + _in_contact(system.contact, engaged, surveyed)
        + _in_grips(system.sticking, grip, system.faces, body, base)
    )
    kinetic += more + vibrating
    axial += more_axial
    work = state[slot.THRUST] + state[slot.GRAVITY]
    lost = (
        state[slot.FRICTION] + state[slot.DAMPING] + state[slot.RELEASED] + state[slot.STRUCTURAL]
    )
    along = (
        state[slot.THRUST_AXIAL]
        + state[slot.GRAVITY_AXIAL]
        - axial
        - state[slot.FRICTION_AXIAL]
        + state[slot.CONTACT_AXIAL]
    )
    total = work - kinetic - kept - lost
    terms = (
        abs(state[slot.THRUST])
        + abs(state[slot.GRAVITY])
        + kinetic
        + kept
        + abs(state[slot.FRICTION])
        + abs(state[slot.DAMPING])
        + abs(state[slot.RELEASED])
        + abs(state[slot.STRUCTURAL])
    )
    return total, total - along, abs(work), kinetic, kinetic - axial + kept, terms


@inlined
def _kinetic(mass, state, body):
    """Kinetic energy (J) of the body whose slots stand first in ``state``, and its axial part."""
    orbit, moment = rotation.cross(body.place, body.velocity), slot.triple(state, slot.MOMENT)
    spin = (moment[0] - mass * orbit[0], moment[1] - mass * orbit[1], moment[2] - mass * orbit[2])
    return (
        0.5 * (mass * rotation.dot(body.velocity, body.velocity) + rotation.dot(spin, body.rate)),
        0.5 * mass * body.velocity[0] * body.velocity[0],
    )


@inlined
def _kinetic_of_platform(platform, state, base):
    kinetic, axial = 0.0, 0.0
    if platform is not None:
        kinetic, axial = _kinetic(platform.mass, state[PLATFORM:], base)
    return kinetic, axial


@inlined
def _of_modes(compliance, state):
    kinetic, strain = 0.0, 0.0
    if compliance is not None:
        kinetic, strain = energies(compliance.modes, state)
    return kinetic, strain


@inlined
def _in_contact(laws, engaged, surveyed):
    energy = 0.0
    if laws is not None:
        for i in range(engaged.size):
            if engaged[i]:
                energy += stored(laws, surveyed[i, DEPTH])
    return energy


@inlined
def _in_grips(sticking, grip, faces, body, base):
    energy = 0.0
    if sticking is not None:
        for i in range(faces.shape[0]):
            energy += grips.kept(sticking, grip[i], faces[i], pad_point(faces[i], body), base)
    return energy


@inlined
def left_contact(state):
    """Energy (J) that has left the contacts."""
    return state[slot.RELEASED] + state[slot.DAMPING]


@inlined
def begin(system, engaged, grip, surveyed, on_walls, state, audit):
    """Take ``state`` for that at ignition."""
    audit[:] = 0.0
    total, across, work, kinetic, scale, terms = balances(
        system, engaged, grip, surveyed, on_walls, state
    )
    audit[FIRST], audit[FIRST_ACROSS], audit[TERMS] = total, across, terms
    audit[SCALE], audit[SCALE_ACROSS] = max(work, kinetic), abs(scale)
    audit[LEFT] = left_contact(state)


@inlined
def affordable(tolerance, mass, audit, found):
    """Whether both ledgers can afford a step that ends with ``found``, its balances."""
    total, across, work, kinetic, scale, terms = found
    slow, rounding = (
        0.5 * mass * tolerance.floor * tolerance.floor,
        _ROUNDING * max(audit[TERMS], terms),
    )
    return _affordable(
        tolerance.total * (max(audit[SCALE], work, kinetic) + slow),
        rounding,
        audit[OFF],
        total - audit[FIRST],
    ) and _affordable(
        tolerance.across * (max(audit[SCALE_ACROSS], abs(scale)) + slow),
        rounding,
        audit[OFF_ACROSS],
        across - audit[FIRST_ACROSS],
    )


@inlined
def _affordable(promise, rounding, before, after):
    """Whether a ledger that is off by ``before`` and then ``after`` (J) keeps to what one step may
    take of a ``promise`` (J)."""
    budget = _HALF * promise
    return abs(after - before) <= max(_SHARE * (budget - abs(before)), _LEAST * budget, rounding)


@inlined
def record(tolerance, mass, start, state, audit, found):
    """Write down a step from ``start`` to ``state`` with the balances ``found``; False when a tenth
    of the scale is lost."""
    total, across, work, kinetic, scale, terms = found
    audit[OFF], audit[OFF_ACROSS] = total - audit[FIRST], across - audit[FIRST_ACROSS]
    audit[WORST], audit[WORST_ACROSS] = (
        max(audit[WORST], abs(audit[OFF])),
        max(audit[WORST_ACROSS], abs(audit[OFF_ACROSS])),
    )
    audit[SCALE], audit[SCALE_ACROSS] = (
        max(audit[SCALE], work, kinetic),
        max(audit[SCALE_ACROSS], abs(scale)),
    )
    audit[TERMS] = max(audit[TERMS], terms)
    for now in (left_contact(start), left_contact(state)):
        audit[LEFT] = max(audit[LEFT], now)
        audit[CREATED] = max(audit[CREATED], audit[LEFT] - now)
    slow, rounding = 0.5 * mass * tolerance.floor * tolerance.floor, _ROUNDING * audit[TERMS]
    lost = (
        abs(audit[OFF]) + audit[CREATED] > _LOST * (audit[SCALE] + slow) + rounding
        or abs(audit[OFF_ACROSS]) + audit[CREATED] > _LOST * (audit[SCALE_ACROSS] + slow) + rounding
    )
    audit[LOST] = 1.0 if lost else 0.0
    return not lost


@kernel
def errors(audit, total, across):
    """Relative errors of the total and the transverse ledger at the ends of all steps, of which
    ``total`` and ``across`` are promised."""
    created = audit[CREATED]
    scale = max(audit[SCALE], _ROUNDING * audit[TERMS] / total)
    scale_across = max(audit[SCALE_ACROSS], _ROUNDING * audit[TERMS] / across)
    return (
        max(audit[WORST], created) / scale if scale > 0.0 else 0.0,
        max(audit[WORST_ACROSS], created) / scale_across if scale_across > 0.0 else 0.0,
    )


@kernel
def usage(audit, total, across):
    """Largest share that a ledger uses of half of what is promised: above one, smaller steps are
    called for."""
    first, second = errors(audit, total, across)
    share = max(first / total, second / across) / _HALF
    return np.inf if audit[LOST] != 0.0 or not share == share else share


@inlined
def after_step(ledger, system, loop):
    """The balances at the end of the step just tried, or None where no ledger is kept."""
    found = None
    if ledger is not None:
        found = _balances(system, loop, loop.end, loop.after)
    return found


@inlined
def step_is_affordable(system, tolerance, loop, found):
    """Whether the step just tried may be kept. Between contacts the forces are smooth, and its
    error says enough."""
    may_be_kept = True
    if found is not None:
        pressing = False
        for felt_now in loop.active:
            pressing = pressing or felt_now
        if pressing:
            may_be_kept = affordable(tolerance, system.payload.mass, loop.audit, found)
    return may_be_kept


@inlined
def record_step(system, tolerance, loop, found):
    """Write down the step just taken; False when it lost a tenth of the energy."""
    kept = True
    if found is not None:
        kept = record(tolerance, system.payload.mass, loop.start, loop.end, loop.audit, found)
    return kept


@inlined
def _balances(system, loop, state, surveyed):
    return balances(system, loop.engaged, loop.grip, surveyed, loop.audit[ON_WALLS], state)


@inlined
def open_books(ledger, compliance, system, loop):
    """Begin the ledgers where the first step does, with what its faces hold from the start."""
    if ledger is not None:
        held = 0.0
        if compliance is not None:
            held = energy_on_walls(
                compliance, system.faces, system.platform, system.payload, loop.active, loop.start
            )
        begin(system, loop.engaged, loop.grip, loop.before, held, loop.start, loop.audit)
