"""Friction that sticks: what holds or drags a touching face, and when that changes.

With the tangential spring k and damper c, the way xi of the face's centre from its anchor on the
wall, its slip velocity u, the normal force N, the direction e of a slide and the capture speed s_c,
the force on the payload is::

    held      F = -k xi - c u                                           until |F| = mu_s N
    sliding   F = -mu_d N g/|g|,   g = u + (s_c + |u.e| - u.e) e        until u.e = 0

Sliding, that is Coulomb's law with its direction turned by at most s_c/|u|; along a straight line
it is one and the same force before the stop and after it, so a step may pass the stop, which is
found on its interpolant as a touch is. There the face is held if |u| <= s_c, else e is turned to u.
Like the set of touching faces, all this is constant within a step.

The spring keeps its stretch while the face slides, as the bristles of a brush do, and is taken up
with it, up to the force mu_d N, where the face is held again; what it does not take up is lost as
friction. Taken up slack it would overshoot under any load near mu_s N, slip and be taken up anew
without end. It can give back only what was put in while the face was held: friction is passive.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined
from tipoff.lowfi.system import NORMAL_Y, NORMAL_Z

# Columns of the table of grips, one row per face: whether it is held; its anchor (m) if so, else e,
# in platform axes; stretch (m) that a slide keeps.
HELD, MARK, STRETCH, GRIP_SIZE = 0, 1, 4, 5
# u.e over s_c that counts as zero: far above the rounding of u, and positive, so that friction
# never drives
STOPPED = 1e-3
SLIPPED = -1e-7  # margin of a held face at which it slips: nearer to zero rounding decides


@inlined
def row_of(sticking, grip, number):
    """Row ``number`` of the table; None where the effect is absent."""
    if sticking is not None:
        return grip[number]
    return None


@inlined
def traction(sticking, row, face, touch, base):
    """Friction on the payload (N, scene axes) of a ``face`` with the load ``touch``, and the power
    (W) it turns into heat."""
    u = touch.slip
    if row[HELD] != 0.0:
        xi = _from_anchor(row, face, touch.point, base)
        k, c = sticking.stiffness, sticking.damping
        return (
            -k * xi[0] - c * u[0],
            -k * xi[1] - c * u[1],
            -k * xi[2] - c * u[2],
        ), c * rotation.dot(u, u)
    g = heading(sticking, row, u, base)
    factor = -sticking.dynamic * max(touch.raw, 0.0) / _size(g)
    force = (factor * g[0], factor * g[1], factor * g[2])
    return force, -rotation.dot(force, u)


@inlined
def heading(sticking, row, u, base):
    """g (m/s) of a slide at slip velocity ``u``, at least s_c long."""
    e = _mark(row, base)
    along = rotation.dot(u, e)
    more = sticking.capture_speed + abs(along) - along
    return (u[0] + more * e[0], u[1] + more * e[1], u[2] + more * e[2])


@inlined
def margin(sticking, row, face, touch, base):
    """What is left until the grip of a touching face changes: (mu_s N - |F|)/(mu_s N + |F|) if it
    is held, u.e/s_c if it slides."""
    left = 1.0
    if row[HELD] == 0.0:
        left = rotation.dot(touch.slip, _mark(row, base)) / sticking.capture_speed
    else:
        force, _ = traction(sticking, row, face, touch, base)
        bound, size = sticking.static * max(touch.raw, 0.0), _size(force)
        if bound + size > 0.0:
            left = (bound - size) / (bound + size)
    return left


@inlined
def used_up(row, before, after):
    """Whether the grip has come to its end in a step from margin ``before`` to ``after``. A face
    that has just slipped has hardly any margin yet, but it gains some."""
    return after <= 0.5 * SLIPPED if row[HELD] != 0.0 else (after <= STOPPED and after < before)


@inlined
def last_margin(row, before):
    """Margin at which a grip that begins a step with ``before`` is to be cut: just within what
    ``used_up`` asks for."""
    return SLIPPED if row[HELD] != 0.0 else 0.5 * min(before, STOPPED)


@inlined
def kept(sticking, row, face, point, base):
    """Energy (J) in the spring of a face whose centre is at ``point``."""
    stretch = row[STRETCH]
    if row[HELD] != 0.0:
        stretch = _size(_from_anchor(row, face, point, base))
    return 0.5 * sticking.stiffness * stretch * stretch


@inlined
def let_go(row):
    """Make a row that of a face that does not touch."""
    row[:] = 0.0
    row[MARK] = 1.0


@inlined
def stop(sticking, row, touch, base):
    """Hold a face that slid, or begins to touch, unless it still moves: then it slides where it
    goes. The energy (J) lost."""
    u, lost = touch.slip, 0.0
    speed = _size(u)
    spare = sticking.dynamic * max(touch.raw, 0.0) - sticking.damping * speed  # N
    if speed <= sticking.capture_speed and spare >= 0.0:
        g = heading(sticking, row, u, base)
        stretch = min(row[STRETCH], spare / sticking.stiffness)
        lost = 0.5 * sticking.stiffness * (row[STRETCH] + stretch) * (row[STRETCH] - stretch)
        back = stretch / _size(g)
        place = (
            touch.point[0] - base.place[0],
            touch.point[1] - base.place[1],
            touch.point[2] - base.place[2],
        )
        _set_mark(
            row, (place[0] - back * g[0], place[1] - back * g[1], place[2] - back * g[2]), 1.0, base
        )
        row[HELD] = 1.0
    else:
        _set_mark(row, u, 1.0 / speed, base)
    return lost


@inlined
def slip(sticking, row, face, touch, base):
    """Let a held face slide: where it moves, or, while it is slower than s_c, where the spring let
    it go."""
    u, speed = touch.slip, _size(touch.slip)
    force, _ = traction(sticking, row, face, touch, base)
    row[STRETCH] = _size(_from_anchor(row, face, touch.point, base))
    row[HELD] = 0.0
    if speed > sticking.capture_speed or rotation.dot(force, u) > 0.0:
        _set_mark(row, u, 1.0 / speed, base)
    else:
        _set_mark(row, force, -1.0 / _size(force), base)


@inlined
def _mark(row, base):
    return rotation.rotate(base.turn, (row[MARK], row[MARK + 1], row[MARK + 2]))


@inlined
def _set_mark(row, vector, factor, base):
    mark = rotation.unrotate(base.turn, vector)
    for i in range(3):
        row[MARK + i] = factor * mark[i]


@inlined
def _from_anchor(row, face, point, base):
    """xi (m) in scene axes: along the wall only, whose normal is that of the face."""
    anchor, n = _mark(row, base), rotation.rotate(base.turn, (0.0, face[NORMAL_Y], face[NORMAL_Z]))
    d = (
        point[0] - base.place[0] - anchor[0],
        point[1] - base.place[1] - anchor[1],
        point[2] - base.place[2] - anchor[2],
    )
    out = rotation.dot(d, n)
    return (d[0] - out * n[0], d[1] - out * n[1], d[2] - out * n[2])


@inlined
def _size(v):
    return np.sqrt(rotation.dot(v, v))
