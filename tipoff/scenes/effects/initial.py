"""Initial state of payload and platform at ignition. Absent table: centred, aligned, at rest.

``mechanics.laws.initial`` states the axes.
"""

from pydantic import Field

from tipoff.mechanics.laws.initial import Initial
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table, is_zero
from tipoff.scenes.units import Angle, Length, Rate, Velocity

EFFECT = Effect("initial", {"initial.position.y": "20 um"})


class Displacement(Table):
    """Lengths along scene axes (m)."""

    #: Along X.
    x: Length = 0.0
    #: Along Y.
    y: Length = 0.0
    #: Along Z.
    z: Length = 0.0


class RotationVector(Table):
    """Axis times angle, in scene axes (rad)."""

    #: About X.
    x: Angle = 0.0
    #: About Y.
    y: Angle = 0.0
    #: About Z.
    z: Angle = 0.0


class LinearVelocity(Table):
    """Inertial velocity in scene axes (m/s)."""

    #: Along X.
    x: Velocity = 0.0
    #: Along Y.
    y: Velocity = 0.0
    #: Along Z.
    z: Velocity = 0.0


class AngularRate(Table):
    """Inertial angular velocity in body axes (rad/s)."""

    #: About body axis x.
    x: Rate = 0.0
    #: About body axis y.
    y: Rate = 0.0
    #: About body axis z.
    z: Rate = 0.0


class InitialTable(Table):
    """``[initial]``: state at ignition. A ``settled`` payload rests on its rails."""

    #: Whether the payload rests on fixed rails under its weight at ignition, at the given travel.
    #: Position along Y and Z and attitude are then the first guess; they are kept where nothing
    #: holds the payload.
    settled: bool = Field(False, exclude_if=is_zero)

    #: Displacement of the payload from its centred place.
    position: Displacement = Displacement()
    #: Rotation vector from scene axes to body axes.
    attitude: RotationVector = RotationVector()
    #: Inertial velocity of the payload.
    velocity: LinearVelocity = LinearVelocity()
    #: Inertial rate of the payload.
    rate: AngularRate = AngularRate()
    #: Inertial velocity of the platform.
    platform_velocity: LinearVelocity = LinearVelocity()
    #: Inertial rate of the platform.
    platform_rate: AngularRate = AngularRate()

    def record(self) -> Initial:
        """Kernel record."""
        return Initial(
            position=_triple(self.position),
            attitude=_triple(self.attitude),
            velocity=_triple(self.velocity),
            rate=_triple(self.rate),
            platform_velocity=_triple(self.platform_velocity),
            platform_rate=_triple(self.platform_rate),
            settled=self.settled,
        )


def _triple(part: Table) -> tuple:
    return tuple(part.model_dump().values())
