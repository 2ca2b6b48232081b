"""Thrust misalignment and eccentricity: direction and line of action of the thrust in body axes.

Angles are counted as in ``scenes.polar``; the eccentricity is measured from the nominal centre.
Absent table: a centred axial force.
"""

from tipoff.mechanics.laws.thrust_offset import ThrustOffset
from tipoff.scenes import polar
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.effects.mass_offset import Eccentricity
from tipoff.scenes.table import Table
from tipoff.scenes.units import Angle

EFFECT = Effect(
    "thrust_offset",
    {
        "thrust_offset.misalignment.axial": "0.1 deg",
        "thrust_offset.misalignment.radial": "35 deg",
    },
)


class Misalignment(Table):
    """Angle from +X (rad) and clock angle from +Y towards +Z (rad)."""

    #: Tilt of the thrust off +X.
    axial: Angle = 0.0
    #: Clock angle of the tilt, from +Y towards +Z.
    radial: Angle = 0.0

    def direction(self) -> tuple[float, float, float]:
        """Unit vector of the thrust in body axes."""
        return polar.direction(self.axial, self.radial)


class ThrustOffsetTable(Table):
    """``[thrust_offset]``: misalignment and eccentricity of the thrust."""

    #: Error of the direction of the thrust.
    misalignment: Misalignment = Misalignment()
    #: Offset of the line of the thrust from the axis.
    eccentricity: Eccentricity = Eccentricity()


def record(thrust_offset, mass_offset, arm: float) -> ThrustOffset | None:
    """Line of action about the actual mass centre, or None for an axial thrust through the mass
    centre.

    ``arm`` is the distance (m) of the point of application behind the nominal centre.
    """
    if thrust_offset is None and mass_offset is None:
        return None
    direction, line, centre = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if thrust_offset is not None:
        direction, line = (
            thrust_offset.misalignment.direction(),
            thrust_offset.eccentricity.offset(),
        )
    if mass_offset is not None:
        centre = mass_offset.eccentricity.offset()
    return ThrustOffset(
        direction, (line[0] - centre[0] - arm, line[1] - centre[1], line[2] - centre[2])
    )
