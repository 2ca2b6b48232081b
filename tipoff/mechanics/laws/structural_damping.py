"""Structural (Rayleigh) damping of the rails, ``C = alpha M + beta K``.

A mode of angular frequency w has the damping ratio ``alpha / 2w + beta w / 2`` (Clough and Penzien,
Dynamics of Structures, section 12-5).
"""

from typing import NamedTuple


class Damping(NamedTuple):
    """Kernel record of Rayleigh damping."""

    mass_rate: float  # 1/s, alpha
    stiffness_time: float  # s, beta
