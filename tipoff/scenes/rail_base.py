"""Parts of every ``[rail]``: ends, material, damping, stiffness of the mounts, and how it is held or
drawn."""

import itertools
import math
from typing import Annotated, ClassVar

from pydantic import Field, ValidationInfo, field_validator

from tipoff.faults import Fault
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes.effects.mount_stiffness import MountStiffnessTable
from tipoff.scenes.effects.structural_damping import DampingTable
from tipoff.scenes.rounding import below
from tipoff.scenes.table import Table, is_absent, limited
from tipoff.scenes.units import (
    SMALLEST_DIMENSION,
    Density,
    Dimension,
    Expansion,
    Length,
    NonNegativeLength,
    PoissonRatio,
    PositiveLength,
    Pressure,
)


def _beyond_start(end: float, info: ValidationInfo) -> float:
    start = info.data.get("start", -math.inf)
    if below(end, start + SMALLEST_DIMENSION, start if math.isfinite(start) else 0.0):
        raise ValueError(f"an end beyond start, by {SMALLEST_DIMENSION:g} m or more")
    return end


class Span(Table):
    """A stretch along the rail measured from its rear end (m)."""

    #: Rear end of the mount, from the rear end of the rail.
    start: NonNegativeLength
    #: Front end of the mount, from the rear end of the rail.
    end: PositiveLength

    _forward = field_validator("end")(_beyond_start)


class MaterialTable(Table):
    """``[rail.material]``: isotropic linear elasticity; only ``[thermal]`` needs ``expansion``
    (1/K)."""

    #: Density.
    density: Density
    #: Young's modulus.
    youngs_modulus: Pressure
    #: Poisson's ratio.
    poisson_ratio: PoissonRatio
    #: Yield strength, beside which the peak stress is reported.
    yield_strength: Pressure | None = None
    #: Coefficient of thermal expansion; [thermal] needs it.
    expansion: Expansion | None = Field(None, exclude_if=is_absent)


class RailBase(Table):
    """Keys of every rail: start and end of its walls along X (m), material, damping, stiffness of
    its mounts."""

    GIVEN_BY: ClassVar[str]
    # whether its walls are straight and along X: the only ones that the surrogates know without
    # the mesh
    IS_STRAIGHT: ClassVar[bool] = False
    #: Rear end of the walls along X.
    start: Length
    #: Open end of the walls along X.
    end: Length
    #: Linear elastic material of the rails.
    material: MaterialTable
    #: Structural damping of the rails.
    damping: DampingTable | None = None
    #: Stiffness of the bolted joints; rigid mounts where absent.
    mount_stiffness: MountStiffnessTable | None = Field(None, exclude_if=is_absent)

    _forward = field_validator("end")(_beyond_start)

    @property
    def length(self) -> float:
        """Length (m) of the walls."""
        return self.end - self.start

    def contents(self) -> dict[str, str]:
        """The keys that name files, each with the digest of the content of its file."""
        return {}

    def libraries(self) -> tuple[str, ...]:
        """Names of the libraries, in addition to ``sources.LIBRARIES``, that its mesh depends
        on."""
        return ()

    def joint(self) -> MountStiffness | None:
        """Plain record of the joints under the mounts; None if these are rigid."""
        return self.mount_stiffness.record() if self.mount_stiffness else None

    def gap(self, clearance: float) -> float:
        """Distance (m) of the walls from the pads in a scene with this clearance (m)."""
        return clearance


class HeldBySpans(RailBase):
    """A rail that is made here from a section, and held at stretches along it."""

    IS_STRAIGHT = True
    #: Stretches along the rail that the platform holds.
    mounts: Annotated[tuple[Span, ...], limited] = ()

    @field_validator("mounts")
    @classmethod
    def _apart_on_the_rail(cls, mounts: tuple[Span, ...], info: ValidationInfo):
        start, end = info.data.get("start", 0.0), info.data.get("end", math.inf)
        length, scale = end - start, max(abs(start), abs(end)) if math.isfinite(end) else 0.0
        if any(below(length, span.end, scale) for span in mounts):
            raise ValueError(f"spans that lie on the rail, which is {length:g} m long")
        inward = sorted(mounts, key=lambda span: span.start)
        if any(below(after.start, before.end) for before, after in itertools.pairwise(inward)):
            raise ValueError("spans that do not overlap")
        return mounts

    def unheld(self, scene: str) -> list[Fault]:
        """The fault of a rail of the ``scene`` of this name that gives way but has no mount."""
        expected = "at least one, since nothing else holds a rail that gives way"
        return [] if self.mounts else [Fault(scene, "rail.mounts", "none", expected)]


class DrawnTable(RailBase):
    """A rail whose walls are drawn in a file or as a section.

    ``clearance`` (m) is that of the drawing; a scene with another one has shims of the difference
    under its pads. ``thickness`` (m) of the walls and ``leg`` (m), their unsupported width, scale
    the bounds of a calibration. They also bound the walls for a pad that comes from behind or from
    the side (``mechanics.model.Plate``).
    """

    #: Clearance for which the rail is drawn; a scene with another one has shims of the
    #: difference under its pads.
    clearance: NonNegativeLength | None = None
    #: Unsupported width of a wall.
    leg: Dimension | None = None
    #: Thickness of a wall.
    thickness: Dimension | None = None

    def gap(self, clearance: float) -> float:
        """Distance (m) of the walls from the pads as drawn, for any clearance of the scene."""
        return clearance if self.clearance is None else self.clearance
