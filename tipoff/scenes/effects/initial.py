"""Initial state of payload and platform at ignition. Absent table: centred, aligned, at rest.

Position is the displacement of the payload from its centred place; attitude is a rotation vector
(axis times angle) from scene axes to body axes. Velocities are inertial, in scene axes; rates are
in the body's own axes.
"""

from typing import NamedTuple

from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table
from tipoff.scenes.units import Angle, Length, Rate, Velocity

EFFECT = Effect("initial", {"initial.position.y": "20 um"})


class Displacement(Table):
    """Lengths along scene axes (m)."""

    x: Length = 0.0
    y: Length = 0.0
    z: Length = 0.0


class RotationVector(Table):
    """Axis times angle, in scene axes (rad)."""

    x: Angle = 0.0
    y: Angle = 0.0
    z: Angle = 0.0


class LinearVelocity(Table):
    """Inertial velocity in scene axes (m/s)."""

    x: Velocity = 0.0
    y: Velocity = 0.0
    z: Velocity = 0.0


class AngularRate(Table):
    """Inertial angular velocity in body axes (rad/s)."""

    x: Rate = 0.0
    y: Rate = 0.0
    z: Rate = 0.0


class InitialTable(Table):
    """``[initial]``: state at ignition."""

    position: Displacement = Displacement()
    attitude: RotationVector = RotationVector()
    velocity: LinearVelocity = LinearVelocity()
    rate: AngularRate = AngularRate()
    platform_velocity: LinearVelocity = LinearVelocity()
    platform_rate: AngularRate = AngularRate()

    def record(self) -> "Initial":
        """Kernel record."""
        return Initial(
            position=_triple(self.position),
            attitude=_triple(self.attitude),
            velocity=_triple(self.velocity),
            rate=_triple(self.rate),
            platform_velocity=_triple(self.platform_velocity),
            platform_rate=_triple(self.platform_rate),
        )


def _triple(part: Table) -> tuple:
    return tuple(part.model_dump().values())


class Initial(NamedTuple):
    """Plain record of the initial state: six triples, SI."""

    position: tuple = (0.0, 0.0, 0.0)
    attitude: tuple = (0.0, 0.0, 0.0)
    velocity: tuple = (0.0, 0.0, 0.0)
    rate: tuple = (0.0, 0.0, 0.0)
    platform_velocity: tuple = (0.0, 0.0, 0.0)
    platform_rate: tuple = (0.0, 0.0, 0.0)
