"""Offset W of walls that are not straight as drawn (``mechanics.drawn_walls``), under the cells of
a pad face. If all walls are straight, ``drawn`` has no places and every function gives zeros."""

from tipoff.kernels.jit import kernel

_NOTHING = (0.0, 0.0, 0.0)


@kernel
def is_drawn(drawn):
    """Whether a wall is not straight as drawn."""
    return drawn.cubic.shape[0] > 0


@kernel
def height(drawn, face, x):
    """Coefficients (m) of 1, eta' and eta'^2 in W at X = ``x`` (m); straight beyond the ends of the
    rail."""
    if is_drawn(drawn):
        c, inside, beyond = _between(drawn, face, x)
        return (
            _value(c[0], inside, beyond),
            _value(c[1], inside, beyond),
            _value(c[2], inside, beyond),
        )
    return _NOTHING


@kernel
def slope(drawn, face, x):
    """Derivatives of ``height`` along the rail."""
    if is_drawn(drawn):
        c, inside, _ = _between(drawn, face, x)
        return (_slope(c[0], inside), _slope(c[1], inside), _slope(c[2], inside))
    return _NOTHING


@kernel
def _between(drawn, face, x):
    """Coefficients (ACROSS, 4) after a place, the distance (m) from it, and the distance (m) beyond
    an end."""
    way, last = x - drawn.start, drawn.cubic.shape[0] - 1
    inside = min(max(way, 0.0), drawn.spacing * (last + 1))
    if not way > 0.0:  # also where the place is not a number
        inside = 0.0
    place = min(int(inside / drawn.spacing), last)
    return drawn.cubic[place, face], inside - place * drawn.spacing, way - inside


@kernel
def _value(c, s, beyond):
    return c[0] + s * (c[1] + s * (c[2] + s * c[3])) + beyond * _slope(c, s)


@kernel
def _slope(c, s):
    return c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])
