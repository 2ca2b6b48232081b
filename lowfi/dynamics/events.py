"""Where inside a step the right-hand side changes its law: a face closes or opens, its force is cut
off, it leaves the rail.

A face that is open when a step begins is not felt within it: the step passes through the wall, the
instant of touching is found on its interpolant (regula falsi of the Illinois kind), and the step
ends there: on its interpolant where the law was one and the same all along and the error leaves
room, else by taking it again up to there. So no step crosses a jump, none is rejected for one, and
no contact is too short to be seen. A gap that closes and opens again by itself is found from the
cubic through its ends. A face off its wall that comes over it within the step ends the step where
it does (``lowfi.contact.wall_ends``), so a wall may be shorter than a step is long. Where friction sticks, a
face that slips or stops ends the step likewise.
"""

import numpy as np

from tipoff.kernels.jit import inlined
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip as grips
from tipoff.lowfi.contact.compliant.survey import depth as depth_in_wall
from tipoff.lowfi.contact.compliant.survey import survey as survey_walls
from tipoff.lowfi.contact.springs import (
    across,
    along,
    approach,
    load,
    penetration,
    relative_motion,
    relative_pose,
    sideways,
)
from tipoff.lowfi.contact.wall_ends import (
    ALONG,
    BEYOND,
    CLOSING,
    DEPTH,
    FORWARD,
    MARGIN,
    MODE,
    NOWHERE,
    PULL,
    SIDE,
    SIDEWAYS,
    SOONEST,
    comes_over,
    depth_it_left_with,
    goes_and_returns,
    stands_over,
    strikes,
)
from tipoff.lowfi.dynamics.dormand_prince import interpolate
from tipoff.lowfi.system import BACK, SIDE_MIDDLE, SIDE_REACH
from tipoff.scenes.effects.contact import stored_energy

_NEAR = 1e-7  # pull that counts as zero
# Modes of a face.
OPEN, PRESSING, CUT_OFF = 0.0, 1.0, 2.0


@inlined
def survey(laws, compliance, sticking, faces, platform, payload, active, grip, state, out):
    """Fill ``out`` (f, SURVEY_SIZE) with mode, penetration (m), its rate (m/s), pull, X (m) and
    margin of grip of every face, the rate of X (m/s), the place across from where the wall has its
    middle (m) and its rate (m/s). The mode of a face off the rail is the one it would have there.
    Walls that give way ask which faces are ``active`` (f,); the energy (J) they hold under those is
    returned."""
    on_walls = 0.0
    if compliance is not None:
        on_walls = survey_walls(
            compliance, faces, platform, payload, active, state, OPEN, PRESSING, out
        )
    if laws is not None:
        body, base = (
            slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
            slot.frame(platform, state),
        )
        place, turn = relative_pose(platform, body, base)
        drift, swing = relative_motion(platform, body, base, place, turn)
        for i in range(out.shape[0]):
            p = penetration(laws.bow, faces[i], place, turn)
            out[i, MODE], out[i, DEPTH], out[i, PULL] = OPEN, p, 1.0
            out[i, ALONG] = along(faces[i], place, turn)
            out[i, CLOSING] = approach(laws.bow, faces[i], place, turn, drift, swing)
            out[i, FORWARD] = (
                drift[0] + swing[0] * faces[i, 0] + swing[1] * faces[i, 1] + swing[2] * faces[i, 2]
            )
            out[i, SIDE] = across(faces[i], place, turn) - faces[i, SIDE_MIDDLE]
            out[i, SIDEWAYS] = sideways(faces[i], drift, swing)
            if p > 0.0:
                face = load(laws, None, platform, faces[i], p, body, base)
                out[i, MODE] = PRESSING if face.raw >= 0.0 else CUT_OFF
                out[i, PULL] = _pull(face)
            out[i, MARGIN] = _margin(
                laws, sticking, grips.row_of(sticking, grip, i), platform, faces[i], p, body, base
            )
    return on_walls


@inlined
def _margin(laws, sticking, row, platform, face, p, body, base):
    """Margin of a face's grip at penetration ``p`` (m): none for a held one across a gap."""
    left = 1.0
    if sticking is not None:
        if p > 0.0:
            left = grips.margin(
                sticking, row, face, load(laws, None, platform, face, p, body, base), base
            )
        elif row[grips.HELD] != 0.0:
            left = -1.0
    return left


@inlined
def _pull(face):
    """Raw force over the sum of the sizes of its elastic and damping parts: -1..1, negative where
    the law would pull."""
    size = face.elastic + abs(face.raw - face.elastic)
    return face.raw / size if size > 0.0 else 1.0


@inlined
def first_event(
    laws,
    compliance,
    sticking,
    payload,
    platform,
    faces,
    rail,
    engaged,
    active,
    grip,
    before,
    after,
    dt,
    span,
    start,
    stages,
    work,
):
    """Fraction (0..1] of the first ``span`` of a step at which it must end, and the face to blame;
    ``before`` and ``after`` survey the ends of that part.

    ``rail`` is its start and end (m); ``work``, as long as ``start``, is scratch.
    """
    first, blamed = 1.0, -1
    if laws is not None:
        for i in range(engaged.size):
            if before[i, MODE] == OPEN and after[i, MODE] == OPEN:
                theta = 1.0
                if engaged[i]:
                    theta = _grazing(
                        before[i, DEPTH],
                        after[i, DEPTH],
                        span * dt * before[i, CLOSING],
                        span * dt * after[i, CLOSING],
                    )
                if theta < first:
                    first, blamed = theta, i
                continue
            if engaged[i]:
                theta = goes_and_returns(rail, faces[i], before[i], after[i], span * dt)
                if SOONEST < theta < first:
                    first, blamed = theta, i
            for kind in (DEPTH, PULL, ALONG, SIDE):
                level = _level(rail, faces[i], engaged[i], kind, before[i], after[i])
                if not np.isnan(level):
                    theta = _locate(
                        laws,
                        compliance,
                        sticking,
                        grips.row_of(sticking, grip, i),
                        payload,
                        platform,
                        faces,
                        i,
                        active,
                        kind,
                        before[i],
                        after[i],
                        level,
                        dt,
                        span,
                        start,
                        stages,
                        work,
                    )
                    if theta < first and (
                        theta > SOONEST or (kind == DEPTH and after[i, DEPTH] > 0.0)
                    ):
                        first, blamed = theta, i
        first, blamed = _change_of_grip(
            laws,
            compliance,
            sticking,
            payload,
            platform,
            faces,
            engaged,
            active,
            grip,
            before,
            after,
            dt,
            span,
            start,
            stages,
            work,
            first,
            blamed,
        )
    if compliance is not None:
        for i in range(engaged.size):
            theta = 1.0
            if engaged[i] and not active[i] and after[i, DEPTH] > BEYOND > before[i, DEPTH]:
                theta = _locate(
                    laws,
                    compliance,
                    sticking,
                    None,
                    payload,
                    platform,
                    faces,
                    i,
                    active,
                    DEPTH,
                    before[i],
                    after[i],
                    BEYOND,
                    dt,
                    span,
                    start,
                    stages,
                    work,
                )
            elif engaged[i] and not active[i] and after[i, MODE] == OPEN:
                theta = _grazing(
                    before[i, DEPTH],
                    after[i, DEPTH],
                    span * dt * before[i, CLOSING],
                    span * dt * after[i, CLOSING],
                )
            if theta < first:
                first, blamed = theta, i
    if laws is not None or compliance is not None:
        for i in range(engaged.size):
            if not engaged[i]:
                theta = _entry(
                    laws,
                    compliance,
                    payload,
                    platform,
                    faces,
                    rail,
                    i,
                    active,
                    before[i],
                    after[i],
                    dt,
                    span,
                    start,
                    stages,
                    work,
                )
                if theta < first:
                    first, blamed = theta, i
    return first, blamed


@inlined
def _entry(
    laws,
    compliance,
    payload,
    platform,
    faces,
    rail,
    number,
    active,
    before,
    after,
    dt,
    span,
    start,
    stages,
    work,
):
    """Fraction of the first ``span`` of a step at which a face comes over its wall and may touch,
    else 1. It is never so small that the step would end where it began: a little later the face is
    over its wall still."""
    kind, level, theta = comes_over(rail, faces[number], before, after, span * dt)
    if kind == NOWHERE:
        return 1.0
    if not np.isnan(level):
        theta = _locate(
            laws,
            compliance,
            None,
            None,
            payload,
            platform,
            faces,
            number,
            active,
            kind,
            before,
            after,
            level,
            dt,
            span,
            start,
            stages,
            work,
        )
    return max(theta, 2.0 * SOONEST / span)


@inlined
def _change_of_grip(
    laws,
    compliance,
    sticking,
    payload,
    platform,
    faces,
    engaged,
    active,
    grip,
    before,
    after,
    dt,
    span,
    start,
    stages,
    work,
    first,
    blamed,
):
    """``first`` and ``blamed``, or the fraction at which a face slips or stops before, and that
    face."""
    if sticking is not None:
        for i in range(engaged.size):
            level = grips.last_margin(grip[i], before[i, MARGIN])
            if (
                engaged[i]
                and before[i, MODE] != OPEN
                and before[i, MARGIN] > level > after[i, MARGIN]
            ):
                theta = _locate(
                    laws,
                    compliance,
                    sticking,
                    grip[i],
                    payload,
                    platform,
                    faces,
                    i,
                    active,
                    MARGIN,
                    before[i],
                    after[i],
                    level,
                    dt,
                    span,
                    start,
                    stages,
                    work,
                )
                if SOONEST < theta < first:
                    first, blamed = theta, i
    return first, blamed


@inlined
def _level(rail, face, engaged, kind, before, after):
    """Value that a face's quantity ``kind`` must reach for its mode to change in this step; NaN
    when it does not change. How it comes over its wall is not asked here."""
    a, b = before[kind], after[kind]
    level = np.nan
    if kind == DEPTH:
        if engaged and (before[MODE] == OPEN) != (after[MODE] == OPEN):
            level = BEYOND
    elif kind == PULL:
        if before[MODE] * after[MODE] == PRESSING * CUT_OFF:
            # The force is continuous there, so what is nearer than rounding is no event.
            level = 0.0 if min(abs(a), abs(b)) > _NEAR else np.nan
    elif engaged and max(before[DEPTH], after[DEPTH]) > BEYOND:
        if kind == ALONG:
            level = _edge(rail[0], rail[1], b)
        else:
            level = _edge(-face[SIDE_REACH], face[SIDE_REACH], b)
    return level if (a - level) * (b - level) < 0.0 else np.nan


@inlined
def _edge(low, high, after):
    """Place (m) just beyond the edge of its wall that a face passes as it leaves; NaN when it
    passes none."""
    if low <= after <= high:
        return np.nan
    return high + BEYOND if after > high else low - BEYOND


@inlined
def _gauge(laws, compliance, sticking, row, payload, platform, faces, number, active, kind, state):
    """Quantity ``kind`` of face ``number`` at ``state``."""
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    if kind == SIDE:
        return across(faces[number], place, turn) - faces[number, SIDE_MIDDLE]
    if compliance is not None:
        if kind == ALONG:
            return place[0] + faces[number, 0]
        return depth_in_wall(compliance, faces, number, active, place, turn, state)
    return _gauge_at_law(
        laws, sticking, row, platform, faces[number], kind, place, turn, body, base
    )


@inlined
def _gauge_at_law(laws, sticking, row, platform, face, kind, place, turn, body, base):
    if kind == ALONG:
        return along(face, place, turn)
    p = _depth(laws, face, place, turn)
    if kind == MARGIN:
        return _margin(laws, sticking, row, platform, face, p, body, base)
    return p if kind == DEPTH else _pull_at(laws, platform, face, p, body, base)


@inlined
def _depth(laws, face, place, turn):
    p = 0.0
    if laws is not None:
        p = penetration(laws.bow, face, place, turn)
    return p


@inlined
def _pull_at(laws, platform, face, p, body, base):
    pull = 1.0
    if laws is not None:
        pull = _pull(load(laws, None, platform, face, max(p, 0.0), body, base))
    return pull


@inlined
def _locate(
    laws,
    compliance,
    sticking,
    row,
    payload,
    platform,
    faces,
    number,
    active,
    kind,
    before,
    after,
    level,
    dt,
    span,
    start,
    stages,
    work,
):
    """Fraction of the first ``span`` of a step at which the quantity passes ``level``; ``before``
    and ``after`` survey its ends."""
    low, high, side = 0.0, 1.0, 0
    f_low, f_high = before[kind] - level, after[kind] - level
    close = 0.1 * abs(level) if kind == MARGIN else 0.1 * _NEAR if kind == PULL else 1e-13
    theta = f_low / (f_low - f_high)
    if kind == DEPTH:
        theta = _cubic_root(
            f_low, f_high, span * dt * before[CLOSING], span * dt * after[CLOSING], theta
        )
    for _ in range(60):
        interpolate(
            dt, span * theta, start, stages, slot.DYNAMIC_SIZE, slot.modal_size(compliance), work
        )
        f = (
            _gauge(
                laws,
                compliance,
                sticking,
                row,
                payload,
                platform,
                faces,
                number,
                active,
                kind,
                work,
            )
            - level
        )
        if abs(f) < close or high - low < 1e-14:
            return theta
        if f * f_high > 0.0:
            high, f_high = theta, f
            f_low = 0.5 * f_low if side == 1 else f_low
            side = 1
        else:
            low, f_low = theta, f
            f_high = 0.5 * f_high if side == -1 else f_high
            side = -1
        theta = (low * f_high - high * f_low) / (f_high - f_low)
    return high


@inlined
def _cubic_root(f_low, f_high, rise, fall, guess):
    """A root in 0..1 of the cubic with these values and slopes at 0 and 1, by Newton's method;
    ``guess`` where it finds none."""
    step = f_high - f_low
    a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
    theta = guess
    for _ in range(8):
        theta -= (f_low + theta * (rise + theta * (b + theta * a))) / (
            rise + theta * (2.0 * b + theta * 3.0 * a)
        )
    return theta if 0.0 < theta < 1.0 else guess


@inlined
def _grazing(before, after, rise, fall):
    """Fraction at which an open gap is narrowest, if it closes in between: maximum of the cubic
    through values and slopes."""
    if not (rise > 0.0 > fall and max(before, after) + max(rise, -fall) > BEYOND):
        return 1.0
    # p(theta) = before + rise theta + b theta^2 + a theta^3
    step = after - before
    a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
    # The form without cancellation: the maximum is the root with p'' < 0.
    theta = rise / (-b + np.sqrt(max(b * b - 3.0 * a * rise, 0.0)))
    depth = before + theta * (rise + theta * (b + theta * a))
    return theta if depth > BEYOND and SOONEST < theta < 1.0 else 1.0


@inlined
def on_rail(laws, compliance, rail, faces, surveyed, left, engaged):
    """Bring ``engaged`` (f,), the faces that stand over their walls, and ``left`` (f,) up to date
    (``lowfi.contact.wall_ends``): whether any changed, energy (J) that leaving faces took with them, less what
    entering ones bring, the part of the latter (J) with which they had left, and a face that
    strikes an edge or is pressed through its wall, or -1. Walls that give way know their energy
    themselves."""
    changed, energy, returned, struck = False, 0.0, 0.0, -1
    if laws is not None or compliance is not None:
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
                energy += (1.0 if engaged[i] else -1.0) * stored(laws, surveyed[i, DEPTH])
                returned += stored(laws, min(surveyed[i, DEPTH], left[i])) if inside else 0.0
                left[i] = 0.0 if inside else max(surveyed[i, DEPTH], 0.0)
                engaged[i] = inside
    return changed, energy, returned, struck


@inlined
def same_law(before, after, active):
    """Whether every felt face keeps its mode from one survey to the other: the right-hand side was
    smooth in between."""
    for i in range(active.size):
        if active[i] and before[i, MODE] != after[i, MODE]:
            return False
    return True


@inlined
def felt(surveyed, engaged, active):
    """Bring ``active`` (f,) up to date, the faces that touch as a step begins; True when any
    changed."""
    changed = False
    for i in range(engaged.size):
        touches = engaged[i] and surveyed[i, MODE] != OPEN
        changed = changed or touches != active[i]
        active[i] = touches
    return changed


@inlined
def stored(laws, depth):
    """Elastic energy (J) of one face at penetration ``depth`` (m), zero across a gap."""
    energy = 0.0
    if laws is not None:
        if depth > 0.0:
            energy = stored_energy(laws.impact, laws.hunt_crossley, laws.linear, depth)
    return energy
