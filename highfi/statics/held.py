"""Rails on their mounts, each factored once for all computations with it."""

from functools import cached_property

import numpy as np

from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly, vibration
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes.rail_base import MaterialTable


class HeldRail:
    """A ``rail`` of ``material`` on rigid mounts or on a ``joint``; it also stands for its mirror
    ``images``, the signs (3,) of each."""

    def __init__(
        self,
        rail: RailMesh,
        images: list[np.ndarray],
        material: MaterialTable,
        joint: MountStiffness | None,
    ):
        self.rail, self.images, self.material, self.joint = rail, images, material, joint
        self._clamped: Clamped | None = None
        self._modes: tuple[np.ndarray, np.ndarray] | None = None

    @cached_property
    def operator(self) -> assembly.Operator:
        return assembly.of_material(self.rail, self.material, joint=self.joint)

    def clamped(self, loads: int) -> Clamped:
        """The factor; the first call chooses it for about so many ``loads``. Raises MeshError if
        nothing holds the rail."""
        if self._clamped is None:
            self._clamped = Clamped(self.operator, loads)
        return self._clamped

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies (n,) rad/s and shapes (d,n) 1/kg^0.5 of the lowest ``count`` modes. Raises
        ValueError if there are fewer."""
        if self._modes is None or self._modes[0].size < count:
            clamped = self.clamped(0)
            mass = np.repeat(self.operator.mass, 3)[clamped.free]
            self._modes = vibration.modes(clamped.stiffness, mass, clamped.solve, count)
        frequency, shape = self._modes
        return frequency[:count], shape[:, :count]


def distinct(
    mesh: RailMesh, material: MaterialTable, joint: MountStiffness | None = None
) -> list[HeldRail]:
    """The distinct rails (``mesh.pieces``) of ``mesh``."""
    return [HeldRail(*each, material, joint) for each in pieces.distinct(mesh)]
