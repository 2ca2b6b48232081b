"""Slopes of a wall that is not straight as drawn, under one pad face, for the step limit.

With W(X, eta') of ``drawn_walls``, h half the length of the face and a the place of its middle
across the rail, the slopes under the face are split into a part that is linear in xi and eta and a
bounded rest::

    dW/dX = s_0 + s_xi xi + s_eta eta + rest,    dW/deta' = t_0 + t_xi xi + t_eta eta + rest

The linear part is taken at the middle and the ends of the face. So a draft, a bow and a twist have
no rest, and a ramp has one only where it begins or ends under the face.
"""

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import drawn_walls
from tipoff.lowfi.contact.compliant.record import ASIDE, MIDDLE

_NOTHING = (0.0, 0.0, 0.0)


@kernel
def along(compliance, face):
    """s_0, s_xi and s_eta (1); zeros if all walls are straight."""
    if drawn_walls.is_drawn(compliance.drawn):
        return _along(compliance, face)
    return _NOTHING


@kernel
def across(compliance, face):
    """t_0, t_xi and t_eta (m); zeros if all walls are straight."""
    if drawn_walls.is_drawn(compliance.drawn):
        return _across(compliance, face)
    return _NOTHING


@kernel
def rest(compliance, face):
    """Bounds of the rest of dW/dX (1) and of dW/deta' (m) in all cells of the face."""
    s, t = _along(compliance, face), _across(compliance, face)
    aside, most_along, most_across = compliance.workspace.lever[face, ASIDE], 0.0, 0.0
    for xi in compliance.node:
        ahead, tilt = _slope(compliance, face, xi), _tilt(compliance, face, xi)
        curved = drawn_walls.slope(compliance.drawn, face, _place(compliance, face, xi))
        off_along = abs(ahead - s[0] - s[1] * xi) + abs(curved[2])
        off_along += abs(curved[1] + 2.0 * aside * curved[2] - s[2])
        bend = drawn_walls.height(compliance.drawn, face, _place(compliance, face, xi))[2]
        off_across = abs(tilt - t[0] - t[1] * xi) + abs(2.0 * bend - t[2])
        most_along, most_across = max(most_along, off_along), max(most_across, off_across)
    return most_along, most_across


@kernel
def _along(compliance, face):
    aside = compliance.workspace.lever[face, ASIDE]
    middle = drawn_walls.slope(compliance.drawn, face, _place(compliance, face, 0.0))
    before, after = _slope(compliance, face, -1.0), _slope(compliance, face, 1.0)
    return (
        _slope(compliance, face, 0.0),
        0.5 * (after - before),
        middle[1] + 2.0 * aside * middle[2],
    )


@kernel
def _across(compliance, face):
    bend = drawn_walls.height(compliance.drawn, face, _place(compliance, face, 0.0))[2]
    before, after = _tilt(compliance, face, -1.0), _tilt(compliance, face, 1.0)
    return _tilt(compliance, face, 0.0), 0.5 * (after - before), 2.0 * bend


@kernel
def _slope(compliance, face, xi):
    """dW/dX at ``xi`` in the middle of the face across the rail."""
    aside = compliance.workspace.lever[face, ASIDE]
    s = drawn_walls.slope(compliance.drawn, face, _place(compliance, face, xi))
    return s[0] + aside * (s[1] + aside * s[2])


@kernel
def _tilt(compliance, face, xi):
    """dW/deta' (m) at ``xi`` in the middle of the face across the rail."""
    aside = compliance.workspace.lever[face, ASIDE]
    w = drawn_walls.height(compliance.drawn, face, _place(compliance, face, xi))
    return w[1] + 2.0 * aside * w[2]


@kernel
def _place(compliance, face, xi):
    """X (m) of a row of cells."""
    return compliance.workspace.lever[face, MIDDLE] + compliance.half[face, 0] * xi
