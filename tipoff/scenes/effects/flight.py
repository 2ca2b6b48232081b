"""The flight after separation: a circular orbit, the direction of the launch axis in it, and a
target. Absent table: no flight.

Orbit axes are R radially outwards, S along the flight, W along the orbit's normal. At zero angles
scene +X is S, +Y is W and +Z is R; azimuth turns X from S towards W, elevation then raises it
towards R, roll turns Y towards Z::

    n = sqrt(mu / (R_e + h)^3)

The target is ``range`` along the launch axis from the payload's nominal mass centre, at rest in
orbit axes at exit, and then falls freely like everything else. Constants: WGS 84 (NIMA TR8350.2),
equatorial radius. The ejection does not depend on this table.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import model_validator

from tipoff.scenes.table import Table, limited
from tipoff.scenes.tables import BoxTable
from tipoff.scenes.units import Angle, PointingLimit, PositiveLength, PositiveRate, PositiveTime

GRAVITATION = 3.986004418e14  # m3/s2, of the Earth
EARTH_RADIUS = 6378137.0  # m
# R, S, W of a scene at zero angles
_ORBIT_FROM_LEVEL = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


class FlightTable(Table):
    """``[flight]``: orbit by altitude (m) or mean_motion (rad/s); azimuth, elevation and roll of
    the launch axis (rad); range of the target (m); duration (s) of the flight, default one orbit;
    pointing_limit (rad), a pointing error whose time is found. ``body`` is the size (m) of the
    payload without its pads, default ``payload.size``; ``envelope`` lists boxes that contain the
    platform, in scene axes at ignition; built-in rails are added to them."""

    #: Altitude of the circular orbit; either this or mean_motion.
    altitude: PositiveLength | None = None
    #: Mean motion of the circular orbit; either this or altitude.
    mean_motion: PositiveRate | None = None
    #: Turns the launch axis from the flight direction towards the orbit's normal.
    azimuth: Angle = 0.0
    #: Raises the launch axis towards the zenith.
    elevation: Angle = 0.0
    #: Turns Y towards Z about the launch axis.
    roll: Angle = 0.0
    #: Distance of the target along the launch axis.
    range: PositiveLength
    #: Duration of the flight; one orbit where absent.
    duration: PositiveTime | None = None
    #: Pointing error whose time is found.
    pointing_limit: PointingLimit | None = None
    #: Size of the payload without its pads; payload.size where absent.
    body: tuple[PositiveLength, PositiveLength, PositiveLength] | None = None
    #: Boxes that contain the platform, in scene axes at ignition.
    envelope: Annotated[tuple[BoxTable, ...], limited] = ()

    @model_validator(mode="after")
    def _one_orbit(self):
        if (self.altitude is None) == (self.mean_motion is None):
            raise ValueError("one of altitude and mean_motion")
        return self

    def record(self) -> "Flight":
        """Plain record."""
        motion = self.mean_motion
        if motion is None:
            assert self.altitude is not None  # one of the two is given
            motion = math.sqrt(GRAVITATION / (EARTH_RADIUS + self.altitude) ** 3)
        return Flight(
            motion,
            _ORBIT_FROM_LEVEL @ _turned(self.azimuth, self.elevation, self.roll),
            self.range,
            self.duration or 2.0 * math.pi / motion,
            self.pointing_limit,
        )


class Flight(NamedTuple):
    """Plain record of the flight."""

    mean_motion: float  # rad/s
    axes: np.ndarray  # (3,3) R, S and W components of scene vectors
    range: float  # m
    duration: float  # s
    pointing_limit: float | None  # rad


def _turned(azimuth: float, elevation: float, roll: float) -> np.ndarray:
    """Scene axes, as columns, in the axes of the scene at zero angles."""
    (ca, ce, cr), (sa, se, sr) = (
        np.cos([azimuth, elevation, roll]),
        np.sin([azimuth, elevation, roll]),
    )
    about_z = np.array([[ca, -sa, 0.0], [sa, ca, 0.0], [0.0, 0.0, 1.0]])
    about_y = np.array([[ce, 0.0, -se], [0.0, 1.0, 0.0], [se, 0.0, ce]])
    return about_z @ about_y @ np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
