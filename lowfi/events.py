"""Where inside a step the right-hand side changes its law: a face closes or opens, its force is cut off, it leaves the rail.

A face that is open when a step begins is not felt within it: the step passes through the wall, the instant of touching is found on
its interpolant (regula falsi of the Illinois kind), and the step ends there: on its interpolant where the law was one and the same
all along and the error leaves room, else by taking it again up to there. So no step crosses a jump, none is rejected for one, and
no contact is too short to be seen. A gap that closes and opens again by itself is found from the cubic through its ends. Where
friction sticks, a face that slips or stops ends the step likewise.
"""

import numpy as np

from lowfi import grip as grips
from lowfi import state as slot
from lowfi.dormand_prince import interpolate
from lowfi.touch import along, approach, load, penetration, relative_motion, relative_pose
from lowfi.walls.survey import depth as depth_in_wall
from lowfi.walls.survey import survey as survey_walls
from scenes.effects.contact import stored_energy
from scenes.jit import inlined

# A crossing is aimed this far beyond itself (m), which is above rounding and below anything a force could feel.
BEYOND = 1e-12
SOONEST = 1e-9  # an event in this first part of a step is the one the step began at
_NEAR = 1e-7  # pull that counts as zero
# Modes of a face, and columns of what ``survey`` fills.
OPEN, PRESSING, CUT_OFF = 0.0, 1.0, 2.0
MODE, DEPTH, CLOSING, PULL, ALONG, MARGIN, SURVEY_SIZE = 0, 1, 2, 3, 4, 5, 6


@inlined
def survey(laws, walls, sticking, faces, platform, payload, active, grip, state, out):
    """Fill ``out`` (f, SURVEY_SIZE) with mode, penetration (m), its rate (m/s), pull, X (m) and margin of grip of every face. The
    mode of a face off the rail is the one it would have there. Walls that give way ask which faces are ``active`` (f,); the energy
    (J) they hold under those is returned."""
    on_walls = 0.0
    if walls is not None:
        on_walls = survey_walls(walls, faces, platform, payload, active, state, (OPEN, PRESSING, MODE, DEPTH, CLOSING, ALONG), out)
    if laws is not None:
        body, base = slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD), slot.frame(platform, state)
        place, turn = relative_pose(platform, body, base)
        drift, swing = relative_motion(platform, body, base, place, turn)
        for i in range(out.shape[0]):
            p = penetration(laws.bow, faces[i], place, turn)
            out[i, MODE], out[i, DEPTH], out[i, PULL] = OPEN, p, 1.0
            out[i, ALONG] = along(faces[i], place, turn)
            out[i, CLOSING] = approach(laws.bow, faces[i], place, turn, drift, swing)
            if p > 0.0:
                face = load(laws, None, platform, faces[i], p, body, base)
                out[i, MODE] = PRESSING if face.raw >= 0.0 else CUT_OFF
                out[i, PULL] = _pull(face)
            out[i, MARGIN] = _margin(laws, sticking, grips.row_of(sticking, grip, i), platform, faces[i], p, body, base)
    return on_walls


@inlined
def _margin(laws, sticking, row, platform, face, p, body, base):
    """Margin of a face's grip at penetration ``p`` (m): none for a held one across a gap."""
    left = 1.0
    if sticking is not None:
        if p > 0.0:
            left = grips.margin(sticking, row, face, load(laws, None, platform, face, p, body, base), base)
        elif row[grips.HELD] != 0.0:
            left = -1.0
    return left


@inlined
def _pull(face):
    """Raw force over the sum of the sizes of its elastic and damping parts: -1..1, negative where the law would pull."""
    size = face.elastic + abs(face.raw - face.elastic)
    return face.raw / size if size > 0.0 else 1.0


@inlined
def first_event(laws, walls, sticking, payload, platform, faces, rail, engaged, active, grip, before, after, dt, span, start,
                stages, work):
    """Fraction (0..1] of the first ``span`` of a step at which it must end, and the face to blame; ``before`` and ``after`` survey
    the ends of that part.

    ``rail`` is its start and end (m); ``work``, as long as ``start``, is scratch.
    """
    first, blamed = 1.0, -1
    if laws is not None:
        for i in range(engaged.size):
            if before[i, MODE] == OPEN and after[i, MODE] == OPEN:
                theta = 1.0
                if engaged[i]:
                    theta = _grazing(before[i, DEPTH], after[i, DEPTH], span * dt * before[i, CLOSING],
                                     span * dt * after[i, CLOSING])
                if theta < first:
                    first, blamed = theta, i
                continue
            for kind in (DEPTH, PULL, ALONG):
                level = _level(rail, engaged[i], kind, before[i], after[i])
                if not np.isnan(level):
                    theta = _locate(laws, walls, sticking, grips.row_of(sticking, grip, i), payload, platform, faces, i, active,
                                    kind, before[i], after[i], level, dt, span, start, stages, work)
                    if theta < first and (theta > SOONEST or (kind == DEPTH and after[i, DEPTH] > 0.0)):
                        first, blamed = theta, i
        first, blamed = _change_of_grip(laws, walls, sticking, payload, platform, faces, engaged, active, grip, before, after, dt,
                                        span, start, stages, work, first, blamed)
    if walls is not None:
        for i in range(engaged.size):
            theta = 1.0
            if engaged[i] and not active[i] and after[i, DEPTH] > BEYOND > before[i, DEPTH]:
                theta = _locate(laws, walls, sticking, None, payload, platform, faces, i, active, DEPTH, before[i], after[i],
                                BEYOND, dt, span, start, stages, work)
            elif engaged[i] and not active[i] and after[i, MODE] == OPEN:
                theta = _grazing(before[i, DEPTH], after[i, DEPTH], span * dt * before[i, CLOSING],
                                 span * dt * after[i, CLOSING])
            if theta < first:
                first, blamed = theta, i
    return first, blamed


@inlined
def _change_of_grip(laws, walls, sticking, payload, platform, faces, engaged, active, grip, before, after, dt, span, start, stages,
                    work, first, blamed):
    """``first`` and ``blamed``, or the fraction at which a face slips or stops before, and that face."""
    if sticking is not None:
        for i in range(engaged.size):
            level = grips.last_margin(grip[i], before[i, MARGIN])
            if engaged[i] and before[i, MODE] != OPEN and before[i, MARGIN] > level > after[i, MARGIN]:
                theta = _locate(laws, walls, sticking, grip[i], payload, platform, faces, i, active, MARGIN, before[i], after[i],
                                level, dt, span, start, stages, work)
                if SOONEST < theta < first:
                    first, blamed = theta, i
    return first, blamed


@inlined
def _level(rail, engaged, kind, before, after):
    """Value that a face's quantity ``kind`` must reach for its mode to change in this step; NaN when it does not change."""
    a, b = before[kind], after[kind]
    level = np.nan
    if kind == DEPTH:
        if engaged and (before[MODE] == OPEN) != (after[MODE] == OPEN):
            level = BEYOND
    elif kind == PULL:
        if before[MODE] * after[MODE] == PRESSING * CUT_OFF:
            # The force is continuous there, so what is nearer than rounding is no event.
            level = 0.0 if min(abs(a), abs(b)) > _NEAR else np.nan
    elif max(before[DEPTH], after[DEPTH]) > BEYOND:
        level = _edge(rail[0], rail[1], engaged, a, b)
    return level if (a - level) * (b - level) < 0.0 else np.nan


@inlined
def _edge(rail_start, rail_end, engaged, before, after):
    """X (m) just beyond the end of the rail a face passes; NaN when it passes none."""
    inside = rail_start <= after <= rail_end
    if engaged == inside:
        return np.nan
    if engaged:
        return rail_end + BEYOND if after > rail_end else rail_start - BEYOND
    return rail_end - BEYOND if before > rail_end else rail_start + BEYOND


@inlined
def _gauge(laws, walls, sticking, row, payload, platform, faces, number, active, kind, state):
    """Quantity ``kind`` of face ``number`` at ``state``."""
    body, base = slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD), slot.frame(platform, state)
    place, turn = relative_pose(platform, body, base)
    if walls is not None:
        return depth_in_wall(walls, faces, number, active, place, turn, state)
    return _gauge_at_law(laws, sticking, row, platform, faces[number], kind, place, turn, body, base)


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
def _locate(laws, walls, sticking, row, payload, platform, faces, number, active, kind, before, after, level, dt, span, start,
            stages, work):
    """Fraction of the first ``span`` of a step at which the quantity passes ``level``; ``before`` and ``after`` survey its ends."""
    low, high, side = 0.0, 1.0, 0
    f_low, f_high = before[kind] - level, after[kind] - level
    close = 0.1 * abs(level) if kind == MARGIN else 0.1 * _NEAR if kind == PULL else 1e-13
    theta = f_low / (f_low - f_high)
    if kind == DEPTH:
        theta = _cubic_root(f_low, f_high, span * dt * before[CLOSING], span * dt * after[CLOSING], theta)
    for _ in range(60):
        interpolate(dt, span * theta, start, stages, slot.DYNAMIC_SIZE, slot.modal_size(walls), work)
        f = _gauge(laws, walls, sticking, row, payload, platform, faces, number, active, kind, work) - level
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
    """A root in 0..1 of the cubic with these values and slopes at 0 and 1, by Newton's method; ``guess`` where it finds none."""
    step = f_high - f_low
    a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
    theta = guess
    for _ in range(8):
        theta -= (f_low + theta * (rise + theta * (b + theta * a))) / (rise + theta * (2.0 * b + theta * 3.0 * a))
    return theta if 0.0 < theta < 1.0 else guess


@inlined
def _grazing(before, after, rise, fall):
    """Fraction at which an open gap is narrowest, if it closes in between: maximum of the cubic through values and slopes."""
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
def on_rail(laws, rail_start, rail_end, surveyed, engaged):
    """Bring ``engaged`` (f,) up to date; (changed, energy (J) that leaving faces took with them, less what entering ones bring)."""
    changed, energy = False, 0.0
    if laws is not None:
        for i in range(engaged.size):
            inside = rail_start <= surveyed[i, ALONG] <= rail_end
            if inside != engaged[i]:
                changed = True
                energy += (1.0 if engaged[i] else -1.0) * stored(laws, surveyed[i, DEPTH])
                engaged[i] = inside
    return changed, energy


@inlined
def same_law(before, after, active):
    """Whether every felt face keeps its mode from one survey to the other: the right-hand side was smooth in between."""
    for i in range(active.size):
        if active[i] and before[i, MODE] != after[i, MODE]:
            return False
    return True


@inlined
def felt(surveyed, engaged, active):
    """Bring ``active`` (f,) up to date, the faces that touch as a step begins; True when any changed."""
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
