"""Rails at an uneven temperature (``mechanics.laws.thermal``). Absent table: T = 0."""

import numpy as np

from tipoff.mechanics.laws.thermal import Thermal
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table
from tipoff.scenes.units import Number, TemperatureChange, TemperatureGradient

EFFECT = Effect("thermal", {"thermal.mean": "5 K", "thermal.gradient.y": "20 K/m"})


class GradientTable(Table):
    """Components along scene axes (K/m)."""

    #: Temperature gradient along X.
    x: TemperatureGradient = 0.0
    #: Temperature gradient along Y.
    y: TemperatureGradient = 0.0
    #: Temperature gradient along Z.
    z: TemperatureGradient = 0.0


class ThermalTable(Table):
    """``[thermal]``: mean change of temperature (K), its gradient, and the strain of the platform
    between the mounts."""

    #: Mean change of temperature since the rails were mounted.
    mean: TemperatureChange = 0.0
    #: Gradient of the change around the middle of the rails.
    gradient: GradientTable = GradientTable()
    #: Growth of the platform between the mounts, as a strain.
    platform_strain: Number = 0.0

    def record(self, rail) -> Thermal:
        """Plain record for the ``[rail]`` of a scene."""
        expansion, gradient = rail.material.expansion, self.gradient
        strains = expansion * np.array([self.mean, gradient.x, gradient.y, gradient.z])
        return Thermal(np.append(strains, self.platform_strain), 0.5 * (rail.start + rail.end))
