"""One sample of a run: positions, velocities, rates, energies and momenta of a state, and the
force on every pad face. And the largest load of each guide, found step by step.

This load is taken at the ends of steps. Between three of them in a row force and moment are parabolas, so
a peak between two ends is not missed, and nothing depends on the sampling interval. A face that begins to
press has no force before; the first step counts at its start too.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import pushers
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip
from tipoff.lowfi.contact.compliant.loads import energy as energy_in_compliance
from tipoff.lowfi.contact.compliant.loads import load as compliant_load
from tipoff.lowfi.contact.compliant.loads import wall_force
from tipoff.lowfi.contact.compliant.modes import energies
from tipoff.lowfi.contact.compliant.solution import solve, solve_unless
from tipoff.lowfi.contact.springs import along, load, penetration, relative_pose
from tipoff.lowfi.dynamics.survey import stored
from tipoff.lowfi.faces import GUIDE, HALF_LENGTH
from tipoff.lowfi.state import (
    IMPULSE,
    PAYLOAD,
    PLACE,
    PLATFORM,
    WORK,
    WORK_SIZE,
    Motion,
)
from tipoff.mechanics import books

# Slots of a sample: payload and platform first (place, velocity, quaternion, rate in body axes),
# each BODY_SIZE long.
RATE = slot.SPIN  # a sample has the rate where the state has the spin
KINETIC, AXIAL_KINETIC, STORED, STRAIN, WORKS = 26, 27, 28, 29, 30
LINEAR, ANGULAR, GIVEN = WORKS + WORK_SIZE, WORKS + WORK_SIZE + 3, WORKS + WORK_SIZE + 6
APART = GIVEN + 6  # 1 if ANGULAR is about the mass centres, else 0
SAMPLE_SIZE = APART + 1


@kernel
def observe(system, loop, row, forces):
    """Fill ``row`` (SAMPLE_SIZE,) and ``forces`` (f,3) N on the payload, in scene axes, from the
    state ``loop.work``; False if a number is not finite."""
    payload, state = system.payload, loop.work
    body = slot.motion(payload, state, PAYLOAD)
    base = slot.frame(system.platform, state)
    row[:] = 0.0
    _place(state, body, base, row)
    apart = loop.counts.apart
    _body(payload.mass, apart, state, PAYLOAD, body, row)
    _platform(system.platform, apart, state, base, row)
    row[APART] = 1.0 if apart else 0.0
    row[STORED] = _observe_springs(system.contact, system, loop, body, base, forces)
    row[STORED] += _observe_compliance(system.compliance, system, loop, body, base, forces)
    _rails(system.compliance, state, row)
    slot.copy(state[WORK:], row[WORKS:], WORK_SIZE)
    _pushers(system.pushing, system.platform, body, base, row)
    slot.copy(state[IMPULSE:], row[GIVEN:], 6)
    finite = _is_finite(row)
    for i in range(forces.shape[0]):
        finite &= _is_finite(forces[i])
    return finite


@kernel
def _pushers(pushing, platform, body, base, row):
    """Replace the integrated work of pushers by that of their potential (``dynamics.audit``)."""
    if pushing.segment.size > 0:
        thrust, axial = WORKS + slot.THRUST - WORK, WORKS + slot.THRUST_AXIAL - WORK
        found = pushers.work(pushing, row[thrust], platform, body, base)
        row[axial] += found - row[thrust]
        row[thrust] = found


@kernel
def _is_finite(values):
    """Whether all ``values`` (n,) are finite; without a branch, which would take longer than the
    sum."""
    found = True
    for value in values:
        found &= abs(value) < np.inf
    return found


@kernel
def posture(system, state, row):
    """Fill only the motion of both bodies in ``row``."""
    _place(
        state,
        slot.motion(system.payload, state, PAYLOAD),
        slot.frame(system.platform, state),
        row,
    )


@kernel
def _place(state, body, base, row):
    _copy(state[:PLATFORM], body, row[:PLATFORM])
    _copy(state[PLATFORM:], base, row[PLATFORM:])


@kernel
def rearmost_edge(faces, platform, row):
    """X (m) in platform axes of the rearmost trailing edge of the pads."""
    place, turn = slot.triple(row, PAYLOAD + PLACE), rotation.matrix(slot.quaternion(row, PAYLOAD))
    body = Motion(place, place, turn, place, place)
    base_place, base_turn = (
        slot.triple(row, PLATFORM + PLACE),
        rotation.matrix(slot.quaternion(row, PLATFORM)),
    )
    place, turn = relative_pose(
        platform, body, Motion(base_place, base_place, base_turn, base_place, base_place)
    )
    rearmost = np.inf
    for i in range(faces.shape[0]):
        rearmost = min(rearmost, along(faces[i], place, turn) - turn[0] * faces[i, HALF_LENGTH])
    return rearmost


@kernel
def _copy(state, body, row):
    """Places and velocities of one body, whose slots come first in ``state`` and ``row``."""
    slot.copy(state, row, RATE)
    for i in range(3):
        row[RATE + i] = body.body_rate[i]


@kernel
def _platform(platform, apart, state, base, row):
    if platform.free:
        _body(platform.mass, apart, state, PLATFORM, base, row)


@kernel
def _body(mass, apart, state, first, body, row):
    """Add kinetic energy and momenta of the body whose slots begin at ``first``. The momenta come
    from its motion, not from A, so the check of the ledger compares both."""
    orbit = slot.orbit(mass, apart, state, first)
    spin = rotation.rotate(body.turn, slot.triple(state, first + slot.SPIN))
    row[KINETIC] += slot.kinetic(mass, state, first, body)
    row[AXIAL_KINETIC] += 0.5 * mass * body.velocity[0] * body.velocity[0]
    for i in range(3):
        row[LINEAR + i] += mass * body.velocity[i]
        row[ANGULAR + i] += orbit[i] + spin[i]


@kernel
def _observe_springs(contact, system, loop, body, base, forces):
    """Fill ``forces`` of contact springs; returns the energy (J) stored in all faces."""
    energy = 0.0
    forces[:] = 0.0
    if contact is not None:
        place, turn = relative_pose(system.platform, body, base)
        for i in range(loop.engaged.size):
            if loop.engaged[i]:
                face = system.faces[i]
                p = penetration(contact.thermal_offset, face, place, turn)
                if p > 0.0:
                    pad = load(contact, system.friction, system.platform, face, p, body, base)
                    energy += stored(contact, p)
                    for j in range(3):
                        forces[i, j] = pad.normal[j] + pad.drag[j]
                    _add_traction(contact.sticking, loop.stick[i], face, pad, base, forces[i])
        energy += stick_slip.stored_in_all(contact.sticking, loop.stick, system.faces, body, base)
    return energy


@kernel
def _observe_compliance(compliance, system, loop, body, base, forces):
    """As ``_observe_springs`` for compliant contact. The next step begins with the displacement of
    the last step, for any sampling."""
    energy = 0.0
    if compliance is not None:
        # Before the first step the touching faces are unknown, so every face may press.
        touching = loop.touching if loop.counts.steps > 0 else loop.engaged
        if touching.any():
            keep_solution(compliance)
            energy = _observe_pressed(compliance, system, touching, loop.work, body, base, forces)
            take_solution_back(compliance)
    return energy


@kernel
def keep_solution(compliance):
    """Keep the solution of compliant contact, before another state is solved."""
    if compliance is not None:
        workspace = compliance.workspace
        _copy_rows(workspace.displacement, workspace.saved_displacement)
        _copy_rows(workspace.lever, workspace.saved_lever)


@kernel
def take_solution_back(compliance):
    """Take the kept solution back."""
    if compliance is not None:
        workspace = compliance.workspace
        _copy_rows(workspace.saved_displacement, workspace.displacement)
        _copy_rows(workspace.saved_lever, workspace.lever)


@kernel
def _observe_pressed(compliance, system, touching, state, body, base, forces):
    """Fill ``forces`` of the ``touching`` faces (f,); returns the energy (J) stored under them."""
    energy, workspace = 0.0, compliance.workspace
    place, turn = relative_pose(system.platform, body, base)
    for rail in range(compliance.members.shape[0]):
        count = solve(compliance, system.faces, rail, touching, place, turn, state)
        energy += energy_in_compliance(compliance, count)
        for k in range(count):
            i = workspace.order[k]
            if workspace.force[i, 0] > 0.0:
                pad = compliant_load(
                    compliance, system.friction, system.platform, system.faces, i, body, base
                )
                aside, _ = wall_force(compliance, system.faces, i, body, base)
                for j in range(3):
                    forces[i, j] = pad.normal[j] + pad.drag[j] + aside[j]
    return energy


@kernel
def _rails(compliance, state, row):
    """Add the energies of the rails' modes."""
    if compliance is not None:
        kinetic, strain = energies(compliance.modes, state)
        row[KINETIC] += kinetic
        row[STRAIN] = strain


@kernel
def _copy_rows(source, target):
    for i in range(source.shape[0]):
        slot.copy(source[i], target[i], source.shape[1])


@kernel
def _add_traction(sticking, row, face, pad, base, force):
    if stick_slip.acts(sticking):
        drag, _ = stick_slip.traction(sticking, row, face, pad, base)
        for j in range(3):
            force[j] += drag[j]


@kernel
def follow_loads(system, loop, loads):
    """Raise ``loads`` to those of the accepted step; without guides there is nothing to do."""
    if loads.shape[1] > 0 and _touches(loop):
        clock = loop.clock
        if loop.counts.steps == 1:
            keep_solution(system.compliance)
            _fill_loads(system, loop, loop.start, False, loads)
            books.take_loads(loads, clock.began)
            take_solution_back(system.compliance)
        elif books.last_load(loads) != clock.began:
            books.clear_loads(loads)
            books.take_loads(loads, clock.began)
        _fill_loads(system, loop, loop.end, True, loads)
        books.take_loads(loads, clock.now)


@kernel
def _touches(loop):
    for i in range(loop.touching.size):
        if loop.touching[i]:
            return True
    return False


@kernel
def _fill_loads(system, loop, state, solved, loads):
    """Fill the rows of a ``state``; ``solved``: compliant contact is solved there."""
    body = slot.motion(system.payload, state, slot.PAYLOAD)
    base = slot.frame(system.platform, state)
    books.clear_loads(loads)
    _add_loads_of_springs(system.contact, system, loop, body, base, loads)
    _add_loads_of_compliance(
        system.compliance, system, loop.touching, state, body, base, solved, loads
    )


@kernel
def _add_load(face, body, force, point, loads):
    arm = (point[0] - body.place[0], point[1] - body.place[1], point[2] - body.place[2])
    own = rotation.unrotate(body.turn, force)
    moment = rotation.cross(rotation.unrotate(body.turn, arm), own)
    books.add_load(loads, int(face[GUIDE]), own, moment)


@kernel
def _add_loads_of_springs(contact, system, loop, body, base, loads):
    if contact is not None:
        place, turn = relative_pose(system.platform, body, base)
        for i in range(loop.touching.size):
            face = system.faces[i]
            p = penetration(contact.thermal_offset, face, place, turn)
            if loop.touching[i] and p > 0.0:
                pad = load(contact, system.friction, system.platform, face, p, body, base)
                _add_load(face, body, pad.normal, pad.point, loads)
                _add_load(face, body, pad.drag, pad.point, loads)
                if stick_slip.acts(contact.sticking):
                    drag, _ = stick_slip.traction(contact.sticking, loop.stick[i], face, pad, base)
                    _add_load(face, body, drag, pad.point, loads)


@kernel
def _add_loads_of_compliance(compliance, system, touching, state, body, base, solved, loads):
    if compliance is not None:
        faces, workspace = system.faces, compliance.workspace
        place, turn = relative_pose(system.platform, body, base)
        for rail in range(compliance.members.shape[0]):
            count = solve_unless(solved, compliance, faces, rail, touching, place, turn, state)
            for k in range(count):
                i = workspace.order[k]
                if workspace.force[i, 0] > 0.0:
                    pad = compliant_load(
                        compliance, system.friction, system.platform, faces, i, body, base
                    )
                    _add_load(faces[i], body, pad.normal, pad.point, loads)
                    _add_load(faces[i], body, pad.drag, pad.point, loads)
                    aside, point = wall_force(compliance, faces, i, body, base)
                    _add_load(faces[i], body, aside, point, loads)
