"""Friction with sticking: the force on a face in contact that sticks or slides, and the transitions
between both.

With the tangential spring k and damper c, the displacement xi of the face's centre from its anchor
on the wall, its slip velocity u, the normal force N, the direction e of a slide and the capture
speed s_c, the force on the payload is::

    sticks    F = -k xi - c u                                           until |F| = mu_s N
    slides    F = -mu_d N g/|g|,   g = u + (s_c + |u.e| - u.e) e        until u.e = 0

In a slide, this is Coulomb's law with its direction turned by at most s_c/|u|. Along a straight
line the force is the same before and after the stop. So a step may pass the stop, which is found on
its interpolant as a contact is. There the face sticks if |u| <= s_c, else e is turned to u. Like
the set of touching faces, these states are constant within a step.

The spring keeps its stretch while the face slides, as the bristles of a brush do. When the face
sticks again, the spring gets the stretch up to the force mu_d N; the rest is lost as friction. A
spring without stretch would overshoot under a load near mu_s N, slip, and begin again without end.
It can return only the energy that was stored while the face stuck: friction is passive.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.springs import pad_point
from tipoff.lowfi.faces import NORMAL_Y, NORMAL_Z

# Columns of the table of stick-slip states, one row per face: whether it sticks; its anchor (m) if
# it does, else the direction e, in platform axes; stretch (m) that a slide keeps.
STICKS, MARK, STRETCH, ROW_SIZE = 0, 1, 4, 5
# u.e over s_c that counts as zero: far above the rounding of u, and positive, so that friction
# never drives
STOPPED = 1e-3
SLIPPED = -1e-7  # margin of a sticking face at which it slips; closer to zero is rounding


@kernel
def acts(sticking):
    """Whether there is friction with sticking."""
    return sticking.stiffness > 0.0


@kernel
def traction(sticking, row, face, pad, base):
    """Friction on the payload (N, scene axes) of a ``face`` with the load ``pad``, and the power
    (W) converted to heat."""
    u = pad.slip
    if row[STICKS] != 0.0:
        xi = _from_anchor(row, face, pad.point, base)
        k, c = sticking.stiffness, sticking.damping
        return (
            -k * xi[0] - c * u[0],
            -k * xi[1] - c * u[1],
            -k * xi[2] - c * u[2],
        ), c * rotation.dot(u, u)
    g = heading(sticking, row, u, base)
    factor = -sticking.dynamic * max(pad.raw, 0.0) / _size(g)
    force = (factor * g[0], factor * g[1], factor * g[2])
    return force, -rotation.dot(force, u)


@kernel
def heading(sticking, row, u, base):
    """g (m/s) of a slide at slip velocity ``u``, at least s_c long."""
    e = _mark(row, base)
    along = rotation.dot(u, e)
    more = sticking.capture_speed + abs(along) - along
    return (u[0] + more * e[0], u[1] + more * e[1], u[2] + more * e[2])


@kernel
def margin(sticking, row, face, pad, base):
    """Distance of a touching face from slip or stop: (mu_s N - |F|)/(mu_s N + |F|) if it sticks,
    u.e/s_c if it slides."""
    left = 1.0
    if row[STICKS] == 0.0:
        left = rotation.dot(pad.slip, _mark(row, base)) / sticking.capture_speed
    else:
        force, _ = traction(sticking, row, face, pad, base)
        bound, size = sticking.static * max(pad.raw, 0.0), _size(force)
        if bound + size > 0.0:
            left = (bound - size) / (bound + size)
    return left


@kernel
def used_up(row, before, after):
    """Whether a face slipped or stopped in a step from margin ``before`` to ``after``. A face that
    has just slipped has almost no margin, but the margin grows."""
    return after <= 0.5 * SLIPPED if row[STICKS] != 0.0 else (after <= STOPPED and after < before)


@kernel
def last_margin(row, before):
    """Margin at which a step that begins with ``before`` must end, so that ``used_up`` is true."""
    return SLIPPED if row[STICKS] != 0.0 else 0.5 * min(before, STOPPED)


@kernel
def stored(sticking, row, face, point, base):
    """Energy (J) in the spring of a face whose centre is at ``point``."""
    stretch = row[STRETCH]
    if row[STICKS] != 0.0:
        stretch = _size(_from_anchor(row, face, point, base))
    return 0.5 * sticking.stiffness * stretch * stretch


@kernel
def stored_in_all(sticking, stick, faces, body, base):
    """Energy (J) in the springs of all faces."""
    energy = 0.0
    if acts(sticking):
        for i in range(faces.shape[0]):
            energy += stored(sticking, stick[i], faces[i], pad_point(faces[i], body), base)
    return energy


@kernel
def clear(row):
    """Reset the row of a face that does not touch."""
    row[:] = 0.0
    row[MARK] = 1.0


@kernel
def stop(sticking, row, pad, base):
    """Let a face stick that slid or begins to touch. If it still moves, it slides in the direction
    of its motion instead. Returns the lost energy (J)."""
    u, lost = pad.slip, 0.0
    speed = _size(u)
    spare = sticking.dynamic * max(pad.raw, 0.0) - sticking.damping * speed  # N
    if speed <= sticking.capture_speed and spare >= 0.0:
        g = heading(sticking, row, u, base)
        stretch = min(row[STRETCH], spare / sticking.stiffness)
        lost = 0.5 * sticking.stiffness * (row[STRETCH] + stretch) * (row[STRETCH] - stretch)
        back = stretch / _size(g)
        place = (
            pad.point[0] - base.place[0],
            pad.point[1] - base.place[1],
            pad.point[2] - base.place[2],
        )
        _set_mark(
            row, (place[0] - back * g[0], place[1] - back * g[1], place[2] - back * g[2]), 1.0, base
        )
        row[STICKS] = 1.0
    else:
        _set_mark(row, u, 1.0 / speed, base)
    return lost


@kernel
def slip(sticking, row, face, pad, base):
    """Let a sticking face slide: in the direction of its motion or, below the speed s_c, against
    the force of the spring."""
    u, speed = pad.slip, _size(pad.slip)
    force, _ = traction(sticking, row, face, pad, base)
    row[STRETCH] = _size(_from_anchor(row, face, pad.point, base))
    row[STICKS] = 0.0
    if speed > sticking.capture_speed or rotation.dot(force, u) > 0.0:
        _set_mark(row, u, 1.0 / speed, base)
    else:
        _set_mark(row, force, -1.0 / _size(force), base)


@kernel
def _mark(row, base):
    return rotation.rotate(base.turn, (row[MARK], row[MARK + 1], row[MARK + 2]))


@kernel
def _set_mark(row, vector, factor, base):
    mark = rotation.unrotate(base.turn, vector)
    for i in range(3):
        row[MARK + i] = factor * mark[i]


@kernel
def _from_anchor(row, face, point, base):
    """xi (m) in scene axes, along the wall with the normal of the face."""
    anchor, n = _mark(row, base), rotation.rotate(base.turn, (0.0, face[NORMAL_Y], face[NORMAL_Z]))
    d = (
        point[0] - base.place[0] - anchor[0],
        point[1] - base.place[1] - anchor[1],
        point[2] - base.place[2] - anchor[2],
    )
    out = rotation.dot(d, n)
    return (d[0] - out * n[0], d[1] - out * n[1], d[2] - out * n[2])


@kernel
def _size(v):
    return np.sqrt(rotation.dot(v, v))
