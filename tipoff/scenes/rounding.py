"""Comparison of inputs with limits, up to rounding.

A value that lies on a limit may have been converted from another unit or computed: 25.4 mm and 1 inch, or
0.3 and 0.1 + 0.2, differ in the last bits. Such values are equal here, on either side of a limit, so that a
scene is accepted or refused alike in all units.
"""

import math

ROUNDING = 1e-12  # relative: thousands of operations, and far below what is made or measured


def at_most(value: float, limit: float, scale: float = 0.0) -> bool:
    """Whether ``value <= limit`` up to rounding. ``scale`` is the largest magnitude from which either
    was computed, where that is larger than both, as of a difference."""
    slack = ROUNDING * max(abs(value), abs(limit), abs(scale))
    return value <= (limit + slack if math.isfinite(slack) else limit)


def below(value: float, limit: float, scale: float = 0.0) -> bool:
    """Whether ``value < limit`` by more than rounding."""
    return not at_most(limit, value, scale)


def on(value: float, limits: tuple[float, ...]) -> float:
    """The one of the ``limits`` that ``value`` is equal to up to rounding, else ``value``."""
    for limit in limits:
        if at_most(value, limit) and at_most(limit, value):
            return limit
    return value
