"""Uniform gravity: every body is accelerated by g, ``F = m g``. Absent table: no body force."""

from pydantic import Field

from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table
from tipoff.scenes.units import Acceleration, Inclination

EFFECT = Effect("gravity", {"gravity.z": "-9.81 m/s**2"}, is_body_force=True)


class GravityTable(Table):
    """``[gravity]``: acceleration components in initial scene axes (m/s2)."""

    #: Acceleration along X.
    x: Acceleration = 0.0
    #: Acceleration along Y.
    y: Acceleration = 0.0
    #: Acceleration along Z.
    z: Acceleration = 0.0
    #: Angle of a rail under its payload above the horizontal plane, in place of x and z: those of
    #: 9.80665 m/s2. A payload with lugs hangs below its rod.
    inclination: Inclination | None = Field(None, exclude=True)

    def body_force(self) -> BodyForce:
        """Kernel record."""
        return BodyForce(self.x, self.y, self.z)
