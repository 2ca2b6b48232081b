"""Where warm walls that give way stand before anything presses them: T of ``mechanics.rail_compliance``, on top
of which comes what load does.

Every function is nothing where ``warm`` is None.
"""

from tipoff.kernels.jit import inlined
from tipoff.mechanics.rail_compliance import PATTERNS, POWERS

_XI, _ETA = POWERS.T.copy()


@inlined
def take(warm, face, station, s, changes):
    """Fill T and its slope along the rail under ``face``, the way ``s`` (m) from a station, which
    goes on with ``changes`` of the place."""
    if warm is not None:
        _fill(warm, face, station, s, changes)


@inlined
def _fill(warm, face, station, s, changes):
    for a in range(PATTERNS):
        c = warm.cubic[station, face, a]
        warm.place[face, a] = c[0] + s * (c[1] + s * (c[2] + s * c[3]))
        warm.slope[face, a] = changes * (c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]))


@inlined
def place(warm, face, pattern):
    """T (m) of one pattern."""
    value = 0.0
    if warm is not None:
        value = warm.place[face, pattern]
    return value


@inlined
def pull(warm, face, force):
    """Force (N) along the rail by which ``force`` (p,) N on a wall that stands farther away ahead
    pushes on."""
    total = 0.0
    if warm is not None:
        for a in range(PATTERNS):
            total += force[a] * warm.slope[face, a]
    return total


@inlined
def recess(warm, face, xi, eta):
    """Slope of the wall at a point of the face."""
    total = 0.0
    if warm is not None:
        for a in range(PATTERNS):
            total += warm.slope[face, a] * xi ** _XI[a] * eta ** _ETA[a]
    return total
