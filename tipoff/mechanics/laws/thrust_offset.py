"""Direction and line of action of the thrust."""

from typing import NamedTuple


class ThrustOffset(NamedTuple):
    """Kernel record, in body axes."""

    direction: tuple  # unit vector
    arm: tuple  # m, from the actual mass centre
