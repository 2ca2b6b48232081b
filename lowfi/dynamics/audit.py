"""Energy ledgers at the end of every step: their errors, and the error that a step may add.

    balance = work - kinetic - strain - stored - losses,     error = balance - balance at ignition

The embedded error of a step does not see energy. Where a face first touches, a law p^e with
fractional exponent has no bounded fifth derivative. Both methods then have one order; the estimate
sees no error. Hundreds of contacts add up, all with one sign. So a step in contact that uses more
than a tenth of the remaining promise is taken again at half its length. Half of a promise is kept
for the interpolation of samples between steps.

Energy lost in contact, ``RELEASED`` and ``DAMPING``, never returns, except the energy of a face
that leaves over an edge of its wall and returns there. Any other returned energy is an error of
both ledgers. The two entries are added, because near the cut-off of a force some stages of a step
count for one and some for the other, with weights of either sign.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import entry, kernel
from tipoff.lowfi import pushers
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip
from tipoff.lowfi.contact.compliant.modes import energies
from tipoff.lowfi.contact.compliant.survey import energy as energy_in_compliance
from tipoff.lowfi.contact.wall_ends import DEPTH
from tipoff.lowfi.dynamics.survey import stored
from tipoff.lowfi.state import PAYLOAD, PLATFORM
from tipoff.mechanics import promises

_HALF = 0.5  # of a promise, for the ends of steps
_SHARE, _LEAST = 0.1, 1e-3  # of the remaining promise, and of the full promise, for one step
_LOST = 0.1
_ROUNDING = promises.ROUNDING


class Balances(NamedTuple):
    """Both ledgers at one instant, J."""

    total: float  # balance of the total ledger
    transverse: float  # balance of the transverse ledger
    work: float  # sum of the sizes of the works, which may cancel
    kinetic: float
    energy_transverse: float  # kinetic without its axial part, and stored
    terms: float  # sum of the sizes of all terms


@kernel
def _balances(system, loop, surveyed, in_compliance, state):
    """Balances at a ``surveyed`` (f, SURVEY_SIZE) state, with the energy (J) in compliant
    contact."""
    body = slot.motion(system.payload, state, PAYLOAD)
    base = slot.frame(system.platform, state)
    kinetic, axial = _kinetic(system.payload.mass, state, PAYLOAD, body)
    more, more_axial = _kinetic_of_platform(system.platform, state, base)
    vibrating, strain = _of_modes(system.compliance, state)
    kept = (
        in_compliance
        + strain
        + _in_springs(system.contact, loop.engaged, surveyed)
        + _in_sticking(system.contact, loop.stick, system.faces, body, base)
    )
    kinetic += more + vibrating
    axial += more_axial
    thrust = pushers.work(system.pushing, state[slot.THRUST], system.platform, body, base)
    work = thrust + state[slot.BODY_FORCE]
    lost = (
        state[slot.FRICTION] + state[slot.DAMPING] + state[slot.RELEASED] + state[slot.STRUCTURAL]
    )
    along = (
        _axial_work(system.pushing, thrust, state)
        + state[slot.BODY_FORCE_AXIAL]
        - axial
        - state[slot.FRICTION_AXIAL]
        + state[slot.CONTACT_AXIAL]
    )
    total = work - kinetic - kept - lost
    terms = (
        abs(thrust)
        + abs(state[slot.BODY_FORCE])
        + kinetic
        + kept
        + abs(state[slot.FRICTION])
        + abs(state[slot.DAMPING])
        + abs(state[slot.RELEASED])
        + abs(state[slot.STRUCTURAL])
    )
    return Balances(
        total=total,
        transverse=total - along,
        work=abs(thrust) + abs(state[slot.BODY_FORCE]),
        kinetic=kinetic,
        energy_transverse=abs(kinetic - axial + kept),
        terms=terms,
    )


@kernel
def _axial_work(pushing, thrust, state):
    """Axial work (J) of the thrust. The work of pushers comes from their potential; its difference
    from the integrated one counts as axial, because it is rounding of the axial motion."""
    axial = state[slot.THRUST_AXIAL]
    if pushing.segment.size > 0:
        axial += thrust - state[slot.THRUST]
    return axial


@kernel
def _kinetic(mass, state, first, body):
    """Kinetic energy (J) of the body whose slots begin at ``first``, and its axial part."""
    axial = 0.5 * mass * body.velocity[0] * body.velocity[0]
    return slot.kinetic(mass, state, first, body), axial


@kernel
def _kinetic_of_platform(platform, state, base):
    kinetic, axial = 0.0, 0.0
    if platform.free:
        kinetic, axial = _kinetic(platform.mass, state, PLATFORM, base)
    return kinetic, axial


@kernel
def _of_modes(compliance, state):
    kinetic, strain = 0.0, 0.0
    if compliance is not None:
        kinetic, strain = energies(compliance.modes, state)
    return kinetic, strain


@kernel
def _in_springs(contact, engaged, surveyed):
    energy = 0.0
    if contact is not None:
        for i in range(engaged.size):
            if engaged[i]:
                energy += stored(contact, surveyed[i, DEPTH])
    return energy


@kernel
def _in_sticking(contact, stick, faces, body, base):
    energy = 0.0
    if contact is not None:
        energy = stick_slip.stored_in_all(contact.sticking, stick, faces, body, base)
    return energy


@kernel
def dissipated(state):
    """Energy (J) that has left the contacts."""
    return state[slot.RELEASED] + state[slot.DAMPING]


@kernel
def open_books(is_compliant, system, loop):
    """Begin the ledgers at the start of the first step, with the energy that its faces already
    store."""
    in_compliance = 0.0
    if is_compliant is not None:
        in_compliance = energy_in_compliance(
            system.compliance,
            system.faces,
            system.platform,
            system.payload,
            loop.touching,
            loop.start,
        )
    audit = loop.audit
    first = _balances(system, loop, loop.before, in_compliance, loop.start)
    audit.error = audit.error_transverse = audit.created = audit.in_compliance = 0.0
    audit.peak_error = audit.peak_error_transverse = 0.0
    audit.failed = False
    audit.first, audit.first_transverse = first.total, first.transverse
    audit.scale = max(first.work, first.kinetic)
    audit.scale_transverse = first.energy_transverse
    audit.terms, audit.dissipated = first.terms, dissipated(loop.start)


@kernel
def after_step(system, loop):
    """Balances at the end of the last attempted step."""
    return _balances(system, loop, loop.after, loop.audit.in_compliance, loop.end)


@kernel
def step_is_affordable(system, tolerance, loop, found):
    """Whether the attempted step may be kept. Between contacts the forces are smooth, and the
    estimated error is sufficient."""
    touching = False
    for touches in loop.touching:
        touching = touching or touches
    return not touching or _is_affordable(tolerance, system.payload.mass, loop.audit, found)


@kernel
def _is_affordable(tolerance, mass, audit, found):
    slow = 0.5 * mass * tolerance.floor * tolerance.floor
    rounding = _ROUNDING * max(audit.terms, found.terms)
    return _keeps_budget(
        tolerance.total * (max(audit.scale, found.work, found.kinetic) + slow),
        rounding,
        audit.error,
        found.total - audit.first,
    ) and _keeps_budget(
        tolerance.transverse * (max(audit.scale_transverse, found.energy_transverse) + slow),
        rounding,
        audit.error_transverse,
        found.transverse - audit.first_transverse,
    )


@kernel
def _keeps_budget(promise, rounding, before, after):
    """Whether a ledger whose error goes from ``before`` to ``after`` (J) keeps to the part of a
    ``promise`` (J) for one step."""
    budget = _HALF * promise
    return abs(after - before) <= max(_SHARE * (budget - abs(before)), _LEAST * budget, rounding)


@kernel
def record_step(system, tolerance, loop, found):
    """Record the accepted step; False if it lost a tenth of the energy."""
    audit, mass = loop.audit, system.payload.mass
    audit.error = found.total - audit.first
    audit.error_transverse = found.transverse - audit.first_transverse
    audit.peak_error = max(audit.peak_error, abs(audit.error))
    audit.peak_error_transverse = max(audit.peak_error_transverse, abs(audit.error_transverse))
    audit.scale = max(audit.scale, found.work, found.kinetic)
    audit.scale_transverse = max(audit.scale_transverse, found.energy_transverse)
    audit.terms = max(audit.terms, found.terms)
    for now in (dissipated(loop.start), dissipated(loop.end)):
        audit.dissipated = max(audit.dissipated, now)
        audit.created = max(audit.created, audit.dissipated - now)
    slow, rounding = 0.5 * mass * tolerance.floor * tolerance.floor, _ROUNDING * audit.terms
    total, transverse = (
        abs(audit.error) + audit.created,
        abs(audit.error_transverse) + audit.created,
    )
    audit.failed = (
        total > _LOST * (audit.scale + slow) + rounding
        or transverse > _LOST * (audit.scale_transverse + slow) + rounding
    )
    return not audit.failed


@entry
def errors(audit, total, transverse):
    """Relative errors of the total and the transverse ledger at the ends of all steps; ``total``
    and ``transverse`` are promised."""
    created = audit.created
    scale = max(audit.scale, _ROUNDING * audit.terms / total)
    scale_transverse = max(audit.scale_transverse, _ROUNDING * audit.terms / transverse)
    return (
        max(audit.peak_error, created) / scale if scale > 0.0 else 0.0,
        max(audit.peak_error_transverse, created) / scale_transverse
        if scale_transverse > 0.0
        else 0.0,
    )


@entry
def usage(audit, total, transverse):
    """Largest error of a ledger over half of its promise: above one, smaller steps are needed."""
    first, second = errors(audit, total, transverse)
    share = max(first / total, second / transverse) / _HALF
    return np.inf if audit.failed or not share == share else share
