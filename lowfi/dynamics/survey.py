"""Contact of every pad face at the ends of a step: the faces that are over their walls, their
penetration, and the faces that touch."""

from tipoff.kernels.jit import kernel
from tipoff.lowfi import pushers
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip
from tipoff.lowfi.contact.compliant.survey import survey as survey_compliance
from tipoff.lowfi.contact.springs import (
    across,
    along,
    approach,
    forward,
    load,
    penetration,
    relative_motion,
    relative_pose,
    sideways,
)
from tipoff.lowfi.contact.wall_ends import (
    ALONG,
    CLOSING,
    CUT_OFF,
    DEPTH,
    FORWARD,
    MARGIN,
    MODE,
    OPEN,
    PRESSING,
    PULL,
    SIDE,
    SIDEWAYS,
    depth_it_left_with,
    stands_over,
    strikes,
)
from tipoff.lowfi.faces import BACK, SIDE_MIDDLE
from tipoff.mechanics.absent import SMOOTH
from tipoff.mechanics.laws.contact import stored_energy


@kernel
def survey(system, loop, solved):
    """Fill ``loop.after`` and the travel of pushers at ``loop.end``, and the energy (J) stored in
    compliant contact;
    ``solved``: that is already solved there. A face off its wall gets the mode that it would have
    there."""
    faces, platform, payload = system.faces, system.platform, system.payload
    pushers.survey(system.pushing, platform, payload, loop.end)
    if system.has_contact:
        _survey_springs(system.contact, faces, platform, payload, loop)
    loop.audit.in_compliance = _survey_compliance(
        system.compliance, faces, platform, payload, loop, solved
    )


@kernel
def _survey_compliance(compliance, faces, platform, payload, loop, solved):
    energy = 0.0
    if compliance is not None:
        energy = survey_compliance(
            compliance, faces, platform, payload, loop.touching, loop.end, solved, loop.after
        )
    return energy


@kernel
def _survey_springs(contact, faces, platform, payload, loop):
    if contact is not None:
        out = loop.after
        body = slot.motion(payload, loop.end, slot.PAYLOAD)
        base = slot.frame(platform, loop.end)
        place, turn = relative_pose(platform, body, base)
        drift, swing = relative_motion(platform, body, base, place, turn)
        for i in range(out.shape[0]):
            p = penetration(contact.thermal_offset, faces[i], place, turn)
            out[i, MODE], out[i, DEPTH], out[i, PULL] = OPEN, p, 1.0
            out[i, ALONG] = along(faces[i], place, turn)
            out[i, CLOSING] = approach(contact.thermal_offset, faces[i], place, turn, drift, swing)
            out[i, FORWARD] = forward(faces[i], drift, swing)
            out[i, SIDE] = across(faces[i], place, turn) - faces[i, SIDE_MIDDLE]
            out[i, SIDEWAYS] = sideways(faces[i], drift, swing)
            if p > 0.0:
                pad = load(contact, SMOOTH, platform, faces[i], p, body, base)
                out[i, MODE] = PRESSING if pad.raw >= 0.0 else CUT_OFF
                out[i, PULL] = pull(pad)
            row = loop.stick[i]
            out[i, MARGIN] = margin(contact, row, platform, faces[i], p, body, base)


@kernel
def pull(pad):
    """Raw force over the sum of the magnitudes of its elastic and damping parts: -1..1, negative
    where the law would pull."""
    size = pad.elastic + abs(pad.raw - pad.elastic)
    return pad.raw / size if size > 0.0 else 1.0


@kernel
def margin(contact, row, platform, face, p, body, base):
    """Stick-slip margin of a face at penetration ``p`` (m); -1 for a sticking face with a gap."""
    left = 1.0
    if stick_slip.acts(contact.sticking):
        if p > 0.0:
            left = stick_slip.margin(
                contact.sticking,
                row,
                face,
                load(contact, SMOOTH, platform, face, p, body, base),
                base,
            )
        elif row[stick_slip.STICKS] != 0.0:
            left = -1.0
    return left


@kernel
def update_engaged(system, loop):
    """Update the faces that are over their walls, and the depths at which others left.

    Returns whether any changed, the energy (J) of leaving faces minus that of entering ones, the
    part of the latter (J) with which they had left, and a face that strikes an edge or is pressed
    through its wall, or -1. Compliant contact counts its energy itself.
    """
    rail = (system.rail_start, system.rail_end)
    return _update_engaged(system.contact, system.has_contact, rail, system.faces, loop)


@kernel
def _update_engaged(contact, has_contact, rail, faces, loop):
    changed, energy, returned, struck = False, 0.0, 0.0, -1
    if has_contact:
        engaged, surveyed, left = loop.engaged, loop.after, loop.depth_left
        for i in range(engaged.size):
            inside = stands_over(rail, faces[i], surveyed[i])
            if not engaged[i]:
                left[i] = depth_it_left_with(rail, faces[i], surveyed[i], left[i])
            if inside != engaged[i]:
                changed = True
                if (
                    strikes(faces[i], surveyed[i], left[i])
                    if inside
                    else surveyed[i, DEPTH] >= faces[i, BACK]
                ):
                    struck = i
                energy += (1.0 if engaged[i] else -1.0) * stored(contact, surveyed[i, DEPTH])
                returned += stored(contact, min(surveyed[i, DEPTH], left[i])) if inside else 0.0
                left[i] = 0.0 if inside else max(surveyed[i, DEPTH], 0.0)
                engaged[i] = inside
    return changed, energy, returned, struck


@kernel
def update_touching(loop):
    """Update the faces that touch at the start of a step; True if any changed."""
    changed = False
    for i in range(loop.engaged.size):
        touches = loop.engaged[i] and loop.after[i, MODE] != OPEN
        changed = changed or touches != loop.touching[i]
        loop.touching[i] = touches
    return changed


@kernel
def keeps_law(loop):
    """Whether every touching face has the same mode at both ends of the step: the right-hand side
    was smooth in between."""
    for i in range(loop.touching.size):
        if loop.touching[i] and loop.before[i, MODE] != loop.after[i, MODE]:
            return False
    return True


@kernel
def stored(contact, depth):
    """Elastic energy (J) of one face at penetration ``depth`` (m), zero across a gap."""
    energy = 0.0
    if contact is not None:
        if depth > 0.0:
            energy = stored_energy(contact.law, depth)
    return energy
