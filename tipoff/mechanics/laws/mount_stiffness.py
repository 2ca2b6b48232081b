"""Bolted joints that hold a rail: traction of a mount strip on the rail per displacement of the strip from
the platform.

    t = -k_n (n . d) n - k_t [d - (n . d) n]

d is the displacement of a point of the surface ``mount`` relative to the platform, n its normal. The
joint is linear: it neither opens nor slips.
"""

from typing import NamedTuple


class MountStiffness(NamedTuple):
    """Plain record of the stiffness."""

    normal: float  # N/m3
    shear: float  # N/m3
