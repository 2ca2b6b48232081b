"""Between two steps: which faces are held from now on, which slide, and what energy leaves their
springs (law: ``lowfi.contact.stick_slip``)."""

from tipoff.kernels.jit import inlined
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip as grips
from tipoff.lowfi.contact.springs import load, penetration, relative_pose
from tipoff.lowfi.dynamics.events import MARGIN, MODE, OPEN


@inlined
def regrip(
    laws, sticking, payload, platform, faces, engaged, active, grip, before, surveyed, state
):
    """Bring ``grip`` (f, GRIP_SIZE) and the margins of ``surveyed`` up to date as a step begins at
    ``state``.

    ``active`` (f,) still tells which faces touched in the step before, ``before`` surveys the begin
    of that. Returns whether anything changed and the energy (J) that friction takes from the
    springs.
    """
    changed, lost = False, 0.0
    if sticking is not None:
        for i in range(engaged.size):
            touches = engaged[i] and surveyed[i, MODE] != OPEN
            if touches != active[i] or (
                touches and grips.used_up(grip[i], before[i, MARGIN], surveyed[i, MARGIN])
            ):
                energy, margin = change(
                    laws, sticking, payload, platform, faces[i], grip[i], active[i], touches, state
                )
                surveyed[i, MARGIN] = margin
                lost += energy
                changed = True
    return changed, lost


@inlined
def grasp(laws, sticking, payload, platform, faces, grip, number, state):
    """Grip of one face that begins to touch at ``state``."""
    if sticking is not None:
        change(laws, sticking, payload, platform, faces[number], grip[number], False, True, state)


@inlined
def change(laws, sticking, payload, platform, face, row, touched, touches, state):
    """Change the grip of a face that begins to touch, slips, stops, or ceases to touch; the energy
    (J) lost, and its new margin."""
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    now = load(
        laws, None, platform, face, max(penetration(laws.bow, face, place, turn), 0.0), body, base
    )
    lost = 0.0
    if not (touched and touches):
        lost = grips.kept(sticking, row, face, now.point, base)
        grips.let_go(row)
    if touches:
        if row[grips.HELD] != 0.0:
            grips.slip(sticking, row, face, now, base)
        else:
            lost += grips.stop(sticking, row, now, base)
    return lost, grips.margin(sticking, row, face, now, base)
