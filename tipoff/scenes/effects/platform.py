"""A free platform that recoils: a second rigid body that carries the rails. Absent table: the rails
are fixed in space.

Mass, inertia and mass centre are those of the whole platform *with* its undeformed rails.
"""

from tipoff.mechanics.laws.platform import Platform
from tipoff.scenes.body import InertiaTensor, inverse, tensor
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.effects.initial import Displacement
from tipoff.scenes.table import Table
from tipoff.scenes.units import Mass

EFFECT = Effect("platform")


class PlatformTable(Table):
    """``[platform]``: mass (kg), inertia about its mass centre (kg m2), mass centre at ignition in
    scene axes (m)."""

    #: Mass of the platform with its rails.
    mass: Mass
    #: Inertia of the platform with its rails, about its mass centre.
    inertia: InertiaTensor
    #: Mass centre at ignition, in scene axes.
    mass_centre: Displacement = Displacement()

    def record(self) -> Platform:
        """Kernel record."""
        inertia = tensor(self.inertia)
        centre = self.mass_centre
        return Platform(self.mass, inertia, inverse(inertia), (centre.x, centre.y, centre.z))
