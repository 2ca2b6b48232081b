"""Largest load of each guide (``mechanics.loads``), found step by step.

It is taken at the ends of steps. Between three of them in a row force and moment are parabolas, so a peak
between two ends is not missed, and nothing depends on the sampling interval. A face that begins to press
has no force before; the first step counts at its start too.
"""

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip
from tipoff.lowfi.contact.compliant.loads import load as compliant_load
from tipoff.lowfi.contact.compliant.loads import wall_force
from tipoff.lowfi.contact.compliant.solution import solve_unless
from tipoff.lowfi.contact.springs import load, penetration, relative_pose
from tipoff.lowfi.dynamics.sample import keep_solution, take_solution_back
from tipoff.lowfi.faces import GUIDE
from tipoff.mechanics import loads as rows


@kernel
def follow(system, loop, loads):
    """Raise ``loads`` to those of the accepted step; without guides there is nothing to do."""
    if loads.shape[1] > 0 and _presses(loop):
        clock = loop.clock
        if loop.counts.steps == 1:
            keep_solution(system.compliance)
            _fill(system, loop, loop.start, False, loads)
            rows.take(loads, clock.began)
            take_solution_back(system.compliance)
        elif rows.last(loads) != clock.began:
            rows.clear(loads)
            rows.take(loads, clock.began)
        _fill(system, loop, loop.end, True, loads)
        rows.take(loads, clock.now)


@kernel
def _presses(loop):
    for i in range(loop.touching.size):
        if loop.touching[i]:
            return True
    return False


@kernel
def _fill(system, loop, state, solved, loads):
    """Fill the rows of a ``state``; ``solved``: compliant contact is solved there."""
    body = slot.motion(system.payload, state, slot.PAYLOAD)
    base = slot.frame(system.platform, state)
    rows.clear(loads)
    _add_springs(system.contact, system, loop, body, base, loads)
    _add_compliance(system.compliance, system, loop.touching, state, body, base, solved, loads)


@kernel
def _add(face, body, force, point, loads):
    arm = (point[0] - body.place[0], point[1] - body.place[1], point[2] - body.place[2])
    own = rotation.unrotate(body.turn, force)
    moment = rotation.cross(rotation.unrotate(body.turn, arm), own)
    rows.add(loads, int(face[GUIDE]), own, moment)


@kernel
def _add_springs(contact, system, loop, body, base, loads):
    if contact is not None:
        place, turn = relative_pose(system.platform, body, base)
        for i in range(loop.touching.size):
            face = system.faces[i]
            p = penetration(contact.thermal_offset, face, place, turn)
            if loop.touching[i] and p > 0.0:
                pad = load(contact, system.friction, system.platform, face, p, body, base)
                _add(face, body, pad.normal, pad.point, loads)
                _add(face, body, pad.drag, pad.point, loads)
                if stick_slip.acts(contact.sticking):
                    drag, _ = stick_slip.traction(contact.sticking, loop.stick[i], face, pad, base)
                    _add(face, body, drag, pad.point, loads)


@kernel
def _add_compliance(compliance, system, touching, state, body, base, solved, loads):
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
                    _add(faces[i], body, pad.normal, pad.point, loads)
                    _add(faces[i], body, pad.drag, pad.point, loads)
                    aside, point = wall_force(compliance, faces, i, body, base)
                    _add(faces[i], body, aside, point, loads)
