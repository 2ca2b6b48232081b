"""Between two steps: the faces that stick or slide in the next step, and the energy that leaves
their springs (law: ``lowfi.contact.stick_slip``)."""

from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip as law
from tipoff.lowfi.contact.springs import load, penetration, relative_pose
from tipoff.lowfi.contact.wall_ends import MARGIN, MODE, OPEN
from tipoff.mechanics.absent import SMOOTH


@kernel
def update(contact, system, loop):
    """Update stick-slip states and surveyed margins at the start ``loop.end`` of a step.

    ``loop.touching`` still has the faces that touched in the step before. Returns whether anything
    changed, and the energy (J) that friction takes from the springs.
    """
    changed, lost = False, 0.0
    if contact is not None:
        if law.acts(contact.sticking):
            changed, lost = _update(contact, system, loop)
    return changed, lost


@kernel
def _update(contact, system, loop):
    changed, lost = False, 0.0
    for i in range(loop.engaged.size):
        touches, touched = loop.engaged[i] and loop.after[i, MODE] != OPEN, loop.touching[i]
        if touches != touched or (
            touches and law.used_up(loop.stick[i], loop.before[i, MARGIN], loop.after[i, MARGIN])
        ):
            energy, margin = _change(contact, system, loop, i, touched, touches, loop.end)
            loop.after[i, MARGIN] = margin
            lost += energy
            changed = True
    return changed, lost


@kernel
def begin_contact(contact, system, loop, face):
    """Stick-slip state of one face, by number, that begins to touch at ``loop.start``."""
    if contact is not None:
        if law.acts(contact.sticking):
            _change(contact, system, loop, face, False, True, loop.start)


@kernel
def _change(contact, system, loop, number, touched, touches, state):
    """Change the state of a face that begins to touch, slips, stops, or ceases to touch; returns
    the lost energy (J) and its new margin."""
    face, row, sticking = system.faces[number], loop.stick[number], contact.sticking
    body = slot.motion(system.payload, state, slot.PAYLOAD)
    base = slot.frame(system.platform, state)
    place, turn = relative_pose(system.platform, body, base)
    depth = max(penetration(contact.thermal_offset, face, place, turn), 0.0)
    now = load(contact, SMOOTH, system.platform, face, depth, body, base)
    lost = 0.0
    if not (touched and touches):
        lost = law.stored(sticking, row, face, now.point, base)
        law.clear(row)
    if touches:
        if row[law.STICKS] != 0.0:
            law.slip(sticking, row, face, now, base)
        else:
            lost += law.stop(sticking, row, now, base)
    return lost, law.margin(sticking, row, face, now, base)
