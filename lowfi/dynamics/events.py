"""Events inside a step, at which the law of the right-hand side changes: a face closes or opens,
its force is cut off, it leaves or enters its wall, it sticks or slips.

A face that is open at the start of a step carries no load in it: the step passes through the wall,
the time of contact is found on its interpolant (regula falsi, Illinois variant), and the step ends
there. It ends on its interpolant if the right-hand side was smooth and the error is small enough,
else it is taken again up to that time. So no step crosses a jump, and no contact is too short to be
found. A gap that closes and opens again within a step is found from the cubic through its ends. A
step ends where a face comes over its wall (``lowfi.contact.wall_ends``), so a wall may be shorter
than a step.
"""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi import pushers
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip
from tipoff.lowfi.contact.compliant.free_vibration import cannot_touch
from tipoff.lowfi.contact.compliant.survey import depth as depth_in_compliance
from tipoff.lowfi.contact.springs import across, along, load, penetration, relative_pose
from tipoff.lowfi.contact.wall_ends import (
    ALONG,
    BEYOND,
    CLOSING,
    CUT_OFF,
    DEPTH,
    MARGIN,
    MODE,
    NOWHERE,
    OPEN,
    PRESSING,
    PULL,
    SIDE,
    SOONEST,
    comes_over,
    goes_and_returns,
)
from tipoff.lowfi.dynamics.dormand_prince import interpolate
from tipoff.lowfi.dynamics.survey import margin, pull
from tipoff.lowfi.faces import SIDE_MIDDLE, SIDE_REACH
from tipoff.mechanics.absent import SMOOTH

_NEAR = 1e-7  # pull that counts as zero


@kernel
def first_event(system, loop, dt, span):
    """Fraction (0..1] of the first ``span`` of a step of ``dt`` (s) at which it must end, and the
    face that causes it. ``loop.before`` and ``loop.after`` survey the ends of that part."""
    first, blamed = _event_on_springs(system.contact, system, loop, dt, span)
    theta, face = _touch_on_compliance(system.is_compliant, system, loop, dt, span)
    if theta < first:
        first, blamed = theta, face
    theta, face = _entry(system, loop, dt, span)
    if theta < first:
        first, blamed = theta, face
    theta = _knot(system.pushing, system, loop, dt, span)
    if theta < first:
        first, blamed = theta, -1
    return first, blamed


@kernel
def _event_on_springs(contact, system, loop, dt, span):
    first, blamed = 1.0, -1
    if contact is not None:
        rail = (system.rail_start, system.rail_end)
        for i in range(loop.engaged.size):
            before, after = loop.before[i], loop.after[i]
            if before[MODE] == OPEN and after[MODE] == OPEN:
                theta = 1.0
                if loop.engaged[i]:
                    theta = _grazing(before, after, span * dt)
                if theta < first:
                    first, blamed = theta, i
                continue
            if loop.engaged[i]:
                theta = goes_and_returns(rail, system.faces[i], before, after, span * dt)
                if SOONEST < theta < first:
                    first, blamed = theta, i
            for kind in (DEPTH, PULL, ALONG, SIDE):
                level = _level(rail, system.faces[i], loop.engaged[i], kind, before, after)
                if not np.isnan(level):
                    theta = _locate(system, loop, dt, span, i, kind, level)
                    if theta < first and (
                        theta > SOONEST or (kind == DEPTH and after[DEPTH] > 0.0)
                    ):
                        first, blamed = theta, i
        theta, face = _change_of_sticking(contact.sticking, system, loop, dt, span)
        if theta < first:
            first, blamed = theta, face
    return first, blamed


@kernel
def _change_of_sticking(sticking, system, loop, dt, span):
    """Fraction at which a touching face slips or stops."""
    first, blamed = 1.0, -1
    if stick_slip.acts(sticking):
        for i in range(loop.engaged.size):
            before, after = loop.before[i], loop.after[i]
            level = stick_slip.last_margin(loop.stick[i], before[MARGIN])
            if loop.engaged[i] and before[MODE] != OPEN and before[MARGIN] > level > after[MARGIN]:
                theta = _locate(system, loop, dt, span, i, MARGIN, level)
                if SOONEST < theta < first:
                    first, blamed = theta, i
    return first, blamed


@kernel
def _touch_on_compliance(is_compliant, system, loop, dt, span):
    """Fraction at which an open face begins to touch on compliant contact."""
    first, blamed = 1.0, -1
    if is_compliant is not None:
        for i in range(loop.engaged.size):
            before, after, theta = loop.before[i], loop.after[i], 1.0
            if cannot_touch(system.compliance.modes, before, after, span * dt):
                continue
            if loop.engaged[i] and not loop.touching[i] and after[DEPTH] > BEYOND > before[DEPTH]:
                theta = _locate(system, loop, dt, span, i, DEPTH, BEYOND)
            elif loop.engaged[i] and not loop.touching[i] and after[MODE] == OPEN:
                theta = _grazing(before, after, span * dt)
            if theta < first:
                first, blamed = theta, i
    return first, blamed


@kernel
def _entry(system, loop, dt, span):
    """Fraction at which a face comes over its wall and may touch. It is never so small that the
    step would end at its start: a little later the face is still over its wall."""
    first, blamed = 1.0, -1
    if system.has_contact:
        rail = (system.rail_start, system.rail_end)
        for i in range(loop.engaged.size):
            if not loop.engaged[i]:
                kind, level, theta = comes_over(
                    rail, system.faces[i], loop.before[i], loop.after[i], span * dt
                )
                if kind == NOWHERE:
                    continue
                if not np.isnan(level):
                    theta = _locate(system, loop, dt, span, i, kind, level)
                theta = max(theta, 2.0 * SOONEST / span)
                if theta < first:
                    first, blamed = theta, i
    return first, blamed


@kernel
def _knot(pushing, system, loop, dt, span):
    """Fraction at which a pusher passes an end of its segment. It is never so small that the step
    would end at its start."""
    first = 1.0
    for i in range(pushing.segment.size):
        level = pushers.passed(pushing, i)
        if not np.isnan(level):
            theta = max(_time_of_travel(system, loop, dt, span, i, level), 2.0 * SOONEST / span)
            first = min(first, theta)
    return first


@kernel
def _time_of_travel(system, loop, dt, span, i, level):
    """Fraction at which pusher ``i`` has the travel ``level`` (m)."""
    pushing = system.pushing
    low, high, side = 0.0, 1.0, 0
    f_low, f_high = pushing.before[i] - level, pushing.after[i] - level
    if f_low * f_high >= 0.0:
        return 0.0
    for _ in range(60):
        theta = (low * f_high - high * f_low) / (f_high - f_low)
        interpolate(system, loop, dt, span * theta, slot.MOVING_SIZE, loop.work)
        f = pushers.travel_at(pushing, i, system.platform, system.payload, loop.work) - level
        if abs(f) < 1e-13 or high - low < 1e-14:
            return theta
        low, f_low, high, f_high, side = _narrowed((low, f_low, high, f_high, side), theta, f)
    return high


@kernel
def _narrowed(bracket, theta, f):
    """The bracket (low, f_low, high, f_high, side) of a root with the new point ``theta``, ``f``. The
    value at an end that stays twice is halved (the Illinois method)."""
    low, f_low, high, f_high, side = bracket
    if f * f_high > 0.0:
        return low, 0.5 * f_low if side == 1 else f_low, theta, f, 1
    return theta, f, high, 0.5 * f_high if side == -1 else f_high, -1


@kernel
def _level(rail, face, engaged, kind, before, after):
    """Value that a face's quantity ``kind`` must reach to change its mode in this step; NaN without
    a change. ``comes_over`` finds how a face comes over its wall."""
    a, b = before[kind], after[kind]
    level = np.nan
    if kind == DEPTH:
        if engaged and (before[MODE] == OPEN) != (after[MODE] == OPEN):
            level = BEYOND
    elif kind == PULL:
        if before[MODE] * after[MODE] == PRESSING * CUT_OFF:
            # The force is continuous there, so distances below rounding are no event.
            level = 0.0 if min(abs(a), abs(b)) > _NEAR else np.nan
    elif engaged and max(before[DEPTH], after[DEPTH]) > BEYOND:
        if kind == ALONG:
            level = _edge(rail[0], rail[1], b)
        else:
            level = _edge(-face[SIDE_REACH], face[SIDE_REACH], b)
    return level if (a - level) * (b - level) < 0.0 else np.nan


@kernel
def _edge(low, high, after):
    """Place (m) just beyond the edge of its wall over which a face leaves; NaN if it does not
    leave."""
    if low <= after <= high:
        return np.nan
    return high + BEYOND if after > high else low - BEYOND


@kernel
def _locate(system, loop, dt, span, face, kind, level):
    """Fraction of the first ``span`` of a step of ``dt`` (s) at which the quantity ``kind`` of a
    face (its number) passes ``level``."""
    before, after = loop.before[face], loop.after[face]
    low, high, side = 0.0, 1.0, 0
    f_low, f_high = before[kind] - level, after[kind] - level
    close = 1e-5 * abs(level) if kind == MARGIN else 1e-5 * _NEAR if kind == PULL else 1e-13
    theta = f_low / (f_low - f_high)
    if kind == DEPTH:
        theta = _cubic_root(
            f_low, f_high, span * dt * before[CLOSING], span * dt * after[CLOSING], theta
        )
    for _ in range(60):
        interpolate(system, loop, dt, span * theta, slot.MOVING_SIZE, loop.work)
        f = _quantity(system.is_compliant, system, loop, face, kind) - level
        if abs(f) < close or high - low < 1e-14:
            return theta
        low, f_low, high, f_high, side = _narrowed((low, f_low, high, f_high, side), theta, f)
        theta = (low * f_high - high * f_low) / (f_high - f_low)
    return high


@kernel
def _quantity(is_compliant, system, loop, number, kind):
    """Quantity ``kind`` of face ``number`` at the state ``loop.work``."""
    payload, state, face = system.payload, loop.work, system.faces[number]
    body = slot.motion(payload, state, slot.PAYLOAD)
    base = slot.frame(system.platform, state)
    place, turn = relative_pose(system.platform, body, base)
    if kind == SIDE:
        return across(face, place, turn) - face[SIDE_MIDDLE]
    if kind == ALONG:
        return along(face, place, turn)
    if is_compliant is not None:
        return depth_in_compliance(
            system.compliance, system.faces, number, loop.touching, place, turn, state
        )
    motions, row = (body, base), loop.stick[number]
    return _quantity_on_springs(system.contact, row, system.platform, face, kind, motions)


@kernel
def _quantity_on_springs(contact, row, platform, face, kind, motions):
    value = 0.0 if kind == DEPTH else 1.0
    if contact is not None:
        body, base = motions
        place, turn = relative_pose(platform, body, base)
        p = penetration(contact.thermal_offset, face, place, turn)
        if kind == DEPTH:
            value = p
        elif kind == MARGIN:
            value = margin(contact, row, platform, face, p, body, base)
        else:
            value = pull(load(contact, SMOOTH, platform, face, max(p, 0.0), body, base))
    return value


@kernel
def _cubic_root(f_low, f_high, rise, fall, guess):
    """A root in 0..1 of the cubic with these values and slopes at 0 and 1, by Newton's method;
    ``guess`` if it finds none."""
    step = f_high - f_low
    a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
    theta = guess
    for _ in range(8):
        theta -= (f_low + theta * (rise + theta * (b + theta * a))) / (
            rise + theta * (2.0 * b + theta * 3.0 * a)
        )
    return theta if 0.0 < theta < 1.0 else guess


@kernel
def _grazing(before, after, dt):
    """Fraction of ``dt`` (s) at which an open gap is narrowest, if it closes in between: the
    maximum of the cubic through depths and their rates."""
    rise, fall = dt * before[CLOSING], dt * after[CLOSING]
    if not (rise > 0.0 > fall and max(before[DEPTH], after[DEPTH]) + max(rise, -fall) > BEYOND):
        return 1.0
    # p(theta) = before + rise theta + b theta^2 + a theta^3
    step = after[DEPTH] - before[DEPTH]
    a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
    # The form without cancellation: the maximum is the root with p'' < 0.
    theta = rise / (-b + np.sqrt(max(b * b - 3.0 * a * rise, 0.0)))
    depth = before[DEPTH] + theta * (rise + theta * (b + theta * a))
    return theta if depth > BEYOND and SOONEST < theta < 1.0 else 1.0
