"""Ends of a wall: which faces are over it, where a face enters it within a step, and which face
strikes its edges.

A wall is a plate. With X of a face's middle, s the place of the middle across the rail, relative to
its centred position, and p the penetration, a face is over its wall while::

    start - o <= X <= end + o,    |s| <= leg + o_s,    p < thickness

Contact springs act at the middle of a face, so o is zero. In compliant contact every part of the
face over the wall acts, so o is half of its length. o_s is half of its width. ``leg`` bounds the
width of the wall, so no part of a face farther away is over it. A face over its wall may lift off,
touch, and leave over any edge.

At p <= 0 a face comes in over the surface. At p > 0 it is behind the surface, and the edge of the
pad meets the edge of the plate. There is no contact law for this. The run ends: a **strike**. The
edge of a pad is set back by its relief, and edges have at least the radius ``ROUNDED``; up to the
sum of both, the pad rides up. A face that left over an edge but is still partly over the wall was
supported by that part, so it may return with the depth at which it left. A face behind the plate (p
>= thickness) has no load; when it returns through p = thickness it strikes the back.
"""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.faces import BACK, HALF_LENGTH, OVERHANG, ROUND, SIDE_REACH
from tipoff.mechanics import outcome

# m, excess of a step beyond a crossing: above rounding, and without effect on any force
BEYOND = 1e-12
SOONEST = 1e-9  # an event in this first part of a step is the event at which the step began
# Columns of a survey (``lowfi.dynamics.survey``), one row per face: mode; penetration (m), its rate
# (m/s) and pull; X (m); stick-slip margin; rate of X (m/s); place across the rail from the middle of
# the wall (m) and its rate (m/s); where rails vibrate, the most penetration (m) that free vibration
# may bring, and its rate (m/s) on a wall at rest.
(
    MODE,
    DEPTH,
    CLOSING,
    PULL,
    ALONG,
    MARGIN,
    FORWARD,
    SIDE,
    SIDEWAYS,
    NEAR,
    NEARING,
    SURVEY_SIZE,
) = range(12)
OPEN, PRESSING, CUT_OFF = 0.0, 1.0, 2.0  # modes
NOWHERE = -1


@kernel
def stands_over(rail, face, row):
    """Whether ``face``, a row of the table of faces, is over its wall, from its ``row`` of a
    survey; ``rail`` is start and end (m)."""
    return (
        rail[0] - face[OVERHANG] <= row[ALONG] <= rail[1] + face[OVERHANG]
        and abs(row[SIDE]) <= face[SIDE_REACH]
        and row[DEPTH] < face[BACK]
    )


@kernel
def strikes(face, row, left):
    """Whether a face that comes over its wall strikes an edge. ``left``: penetration (m) at which
    it left, zero if no part of it was over the wall since."""
    return row[DEPTH] > face[ROUND] + left


@kernel
def depth_it_left_with(rail, face, row, left):
    """``left`` (m), or zero if no part of a face is over the wall."""
    half = face[HALF_LENGTH]
    beside = abs(row[SIDE]) > face[SIDE_REACH]
    return (
        0.0
        if beside or row[DEPTH] >= face[BACK] or not rail[0] - half <= row[ALONG] <= rail[1] + half
        else left
    )


@kernel
def turning_point(before, after, rise, fall):
    """Fraction at which a cubic with these values and slopes at 0 and 1 has an extreme, and its
    value there; 1 and ``after`` if its slopes have the same sign."""
    theta, value = 1.0, after
    if rise * fall < 0.0:
        # p(theta) = before + rise theta + b theta^2 + a theta^3; form without cancellation
        step = after - before
        a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
        root = np.sqrt(max(b * b - 3.0 * a * rise, 0.0))
        theta = rise / (root - b) if rise > 0.0 else -rise / (root + b)
        value = before + theta * (rise + theta * (b + theta * a))
    return theta, value


@kernel
def _interval(rail, face, kind):
    """Interval (m) of a face's quantity ``kind`` in which it is over its wall and may touch."""
    if kind == ALONG:
        return rail[0] - face[OVERHANG], rail[1] + face[OVERHANG]
    if kind == SIDE:
        return -face[SIDE_REACH], face[SIDE_REACH]
    return BEYOND, face[BACK]


@kernel
def _rate(kind):
    """Column of the rate of a quantity."""
    return FORWARD if kind == ALONG else SIDEWAYS if kind == SIDE else CLOSING


@kernel
def comes_over(rail, face, before, after, dt):
    """Place in a step of ``dt`` (s) at which a face comes over its wall and may touch: the quantity
    whose interval it enters, the level (m) that it passes, and the fraction of the step.

    The quantity is NOWHERE if it does not. The level is NaN if the quantity is inside only between
    the ends of the step: then the fraction is at its extreme, and the step up to there contains the
    entry. The ends may be on either side of a wall that is shorter than the step. In this way a
    face may be taken as over its wall too early, never too late.
    """
    entered, level, fraction = NOWHERE, np.nan, 1.0
    for kind in (ALONG, SIDE, DEPTH):
        low, high = _interval(rail, face, kind)
        a, b = before[kind], after[kind]
        theta, turn = turning_point(a, b, dt * before[_rate(kind)], dt * after[_rate(kind)])
        if max(a, b, turn) < low or min(a, b, turn) > high:
            return NOWHERE, np.nan, 1.0
        # A face in front of its wall meets nothing.
        if entered == NOWHERE and (a > high or (a < low and kind != DEPTH)):
            entered, fraction = kind, theta
            if a > high:
                level = high - BEYOND if b < high else np.nan
            else:
                level = low + BEYOND if b > low else np.nan
    return entered, level, fraction


@kernel
def goes_and_returns(rail, face, before, after, dt):
    """Fraction of a step at which a face that is over its wall at both ends is farthest beyond an
    edge; 1 if it stays over the wall."""
    for kind in (ALONG, SIDE):
        low, high = _interval(rail, face, kind)
        if low <= after[kind] <= high:
            theta, turn = turning_point(
                before[kind], after[kind], dt * before[_rate(kind)], dt * after[_rate(kind)]
            )
            if turn > high + BEYOND or turn < low - BEYOND:
                return theta
    return 1.0


def strike(model, number: int, face: np.ndarray, row: np.ndarray, time: float) -> str:
    """Message of a strike: face ``number`` of ``model``, its rows (FACE_SIZE,) and (SURVEY_SIZE,)
    of table and survey, and the time (s). The step ended just inside the edge, so the nearest edge
    is named."""
    x, over, depth = row[ALONG], face[OVERHANG], row[DEPTH]
    away = {
        "the rear end": x - model.rail_start + over,
        "the open end": model.rail_end + over - x,
        "a side": face[SIDE_REACH] - abs(row[SIDE]),
        "the back": face[BACK] - depth,
    }
    edge = (
        "strikes " + min(away, key=away.__getitem__)
        if depth < face[BACK]
        else "is pressed through a wall"
    )
    origin = model.platform.mass_centre[0] if model.platform is not None else 0.0
    return outcome.strike(model.faces, number, edge, depth, x + origin, time)
