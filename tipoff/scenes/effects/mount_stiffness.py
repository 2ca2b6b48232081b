"""Stiffness of the bolted joints that hold a rail: traction of a mount strip on the rail per
displacement of the strip from the platform.

    t = -k_n (n . d) n - k_t [d - (n . d) n]

d is the displacement of a point of the surface ``mount`` relative to the platform, n its normal,
k_n and k_t the normal and the shear stiffness per area. The joint is linear: it neither opens nor
slips. Absent table: rigid mounts, d = 0, the limit of k_n and k_t to infinity.

Two machined surfaces under the pressure p approach each other by c p^m with m about 0.5, so that the
normal stiffness dp / d(c p^m) = p^(1-m) / (c m) grows with the root of the pressure: Back, Burdekin
and Cowley, Review of the research on fixed and sliding joints, Proc. 13th MTDR Conf. 1973, 87-97,
and Analysis of machine tool joints by the finite element method, Proc. 14th MTDR Conf. 1974,
529-537. The shear stiffness of elastic asperities is 2 (1 - nu) / (2 - nu) of the normal one, 0.80
with nu = 0.33, as long as nothing slips: Mindlin, J. Appl. Mech. 16 (1949) 259-268; Campana, Persson
and Mueser, J. Phys.: Condens. Matter 23 (2011) 085001.
"""

from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table
from tipoff.scenes.units import InterfaceStiffness, PositiveNumber

EFFECT = Effect(
    "rail.mount_stiffness",
    {"rail.mount_stiffness.normal": "1e13 N/m**3", "rail.mount_stiffness.shear": "5e12 N/m**3"},
)


class MountStiffnessTable(Table):
    """``[rail.mount_stiffness]``: stiffness per area (N/m3) of the joints along the normal of a
    mount strip and across it. ``factor`` multiplies both; studies of uncertainty vary it."""

    #: Stiffness per area along the normal of a mount strip.
    normal: InterfaceStiffness
    #: Stiffness per area across that normal.
    shear: InterfaceStiffness
    #: Multiplies both; studies of uncertainty vary it.
    factor: PositiveNumber = 1.0

    def record(self) -> MountStiffness:
        """Plain record."""
        return MountStiffness(self.factor * self.normal, self.factor * self.shear)
