"""Hold-down of latch and stop: it takes the force lambda along the rail that keeps the travel constant, and
gives it back to the platform. It acts on the line of the nominal mass centre along the rail, and never
holds again::

    lambda = -a / w      a: acceleration of the travel by all other forces, w: that by a unit force
"""

from typing import NamedTuple


class HoldDown(NamedTuple):
    """Kernel record."""

    release: float  # s, time of the release
    line: tuple  # (2,) m, places along Y and Z of the line on which it acts, in platform axes
    is_stop: bool  # whether it is released when the payload leaves its stop
