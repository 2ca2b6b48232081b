"""Vibration of the rails in the surrogate: the lowest modes of every rail on walls that give way. Absent table: rails without
inertia.

    q_i'' + (alpha + beta omega_i^2) q_i' + omega_i^2 q_i = the work of the pads' pressure on mode i, mass-normalised

The other modes follow at once, as statics has them, so that their number changes no static answer. alpha and beta are those of
``[rail.damping]``. The reference, where the modes come from, has all of them and does not read the table.
"""

from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator

from scenes.effects.structural_damping import Damping
from scenes.table import Table

MOST = 20  # modes of a rail that walls are stored with


class Flexibility(NamedTuple):
    """Number of modes of each rail, and what damps them."""

    modes: int
    damping: Damping | None


def _count(value: Any) -> int:
    number = int(value) if isinstance(value, str) and value.isdecimal() else value
    if type(number) is not int or not 0 <= number <= MOST:
        raise ValueError(f"a whole number from 0 to {MOST}")
    return number


class FlexibilityTable(Table):
    """``[flexibility]``: how many modes of each rail move; 0 leaves the walls of statics."""

    modes: Annotated[int, BeforeValidator(_count)]

    def record(self, damping: Damping | None) -> Flexibility:
        """Record of the modes under the damping of the rails."""
        return Flexibility(self.modes, damping)
