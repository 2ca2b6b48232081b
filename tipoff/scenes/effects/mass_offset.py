"""Mass eccentricity: the payload's mass centre lies off its nominal place, ``l_y = r1 sin b``,
``l_z = r1 cos b``.

Pads and thrust keep their places relative to the nominal centre, so their arms about the actual
mass centre change by ``-l``. The inertia is about the actual mass centre and does not change.
Absent table: the centres coincide.
"""

from tipoff.scenes import polar
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table
from tipoff.scenes.units import Angle, NonNegativeLength

EFFECT = Effect(
    "mass_offset",
    {
        "mass_offset.eccentricity.axial": "0.1 mm",
        "mass_offset.eccentricity.radial": "120 deg",
    },
)


class Eccentricity(Table):
    """Radius r (m) and radial angle (rad): ``l_z = r cos``, ``l_y = r sin``."""

    #: Radius of the offset from the axis.
    axial: NonNegativeLength = 0.0
    #: Clock angle of the offset, from +Z towards +Y.
    radial: Angle = 0.0

    def offset(self) -> tuple[float, float, float]:
        """Offset (m) in body axes."""
        return (0.0, *polar.offset(self.axial, self.radial))


class MassOffsetTable(Table):
    """``[mass_offset]``: place of the mass centre relative to the nominal centre."""

    #: Offset of the actual mass centre from the nominal one.
    eccentricity: Eccentricity = Eccentricity()
