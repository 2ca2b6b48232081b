"""Comparison of inputs with limits, up to rounding.

A value on a limit may have been converted from another unit or computed: 25.4 mm and 1 inch, or 0.3
and 0.1 + 0.2, differ in the last bits. Such values count as equal here, on both sides of a limit,
so that a scene is accepted or refused equally in all units.
"""

import math
from collections.abc import Callable

MOST_DIGITS = 17  # of a number in double precision
ROUNDING = 1e-12  # relative: above thousands of operations, below any measurement


def at_most(value: float, limit: float, scale: float = 0.0) -> bool:
    """Whether ``value <= limit`` up to rounding. ``scale`` is the largest magnitude in the
    computation of either, if that is larger than both, for example for a difference."""
    slack = ROUNDING * max(abs(value), abs(limit), abs(scale))
    return value <= (limit + slack if math.isfinite(slack) else limit)


def below(value: float, limit: float, scale: float = 0.0) -> bool:
    """Whether ``value < limit`` by more than rounding."""
    return not at_most(limit, value, scale)


def plain(value: float, digits: int) -> str:
    """A number as text."""
    return f"{value:.{digits}g}"


def apart(
    value: float, limit: float, digits: int = 6, shown: Callable[[float, int], str] = plain
) -> tuple[str, str]:
    """Texts of a refused value and of its limit, by ``shown`` with ``digits`` or as many more as tell
    them apart. Both have the same text if they are equal up to rounding."""
    equal = at_most(value, limit) and at_most(limit, value)
    texts = shown(value, digits), shown(limit, digits)
    while texts[0] == texts[1] and not equal and digits < MOST_DIGITS:
        digits += 1
        texts = shown(value, digits), shown(limit, digits)
    return texts


def on(value: float, limits: tuple[float, ...]) -> float:
    """The limit that equals ``value`` up to rounding, else ``value``."""
    for limit in limits:
        if at_most(value, limit) and at_most(limit, value):
            return limit
    return value
