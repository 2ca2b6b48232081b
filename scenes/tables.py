"""The tables every scene has: payload, pads, rail, output, and what the agreement study fits and scores."""

from typing import Literal

from pydantic import Field, model_validator

from scenes.body import InertiaTensor
from scenes.table import Table
from scenes.units import Density, Length, Mass, NonNegativeLength, PositiveLength, PositiveTime, Pressure, quantity

Normal = Literal["+y", "-y", "+z", "-z"]


class PayloadTable(Table):
    """``[payload]``: mass, inertia about the actual mass centre, and (for plausibility) outer size."""

    mass: Mass
    inertia: InertiaTensor
    size: tuple[PositiveLength, PositiveLength, PositiveLength] | None = None


class PadTable(Table):
    """``[[pads]]``: a pad on the payload; each normal is one flat face, crowned by ``relief`` at its edges.

    ``position`` is the pad's corner measured from the nominal mass centre. A face with normal along y is centred
    ``inset`` towards the payload's axis along z (and the other way round).
    """

    position: tuple[Length, Length, Length]
    normals: list[Normal] = Field(min_length=1)
    length: PositiveLength = 0.016
    width: PositiveLength = 0.016
    inset: NonNegativeLength = 0.0
    relief: NonNegativeLength = 0.0


class Span(Table):
    """A stretch along the rail measured from its rear end (m)."""

    start: NonNegativeLength
    end: PositiveLength

    @model_validator(mode="after")
    def _forward(self):
        if self.end <= self.start:
            raise ValueError("end beyond start")
        return self


class MaterialTable(Table):
    """``[rail.material]``: isotropic linear elasticity."""

    density: Density
    youngs_modulus: Pressure
    poisson_ratio: quantity("dimensionless", gt=-1.0, lt=0.5)
    yield_strength: Pressure | None = None


class RailTable(Table):
    """``[rail]``: L sections from ``start`` to ``end`` along X, clamped to the platform at ``mounts``."""

    start: Length
    end: Length
    leg: PositiveLength = 0.024
    thickness: PositiveLength = 0.004
    mount_width: PositiveLength = 0.004
    mounts: list[Span] = Field(default_factory=list)
    material: MaterialTable

    @model_validator(mode="after")
    def _consistent(self):
        if self.end <= self.start:
            raise ValueError("end beyond start")
        if self.thickness >= self.leg:
            raise ValueError("thickness below leg")
        if any(span.end > self.end - self.start + 1e-12 for span in self.mounts):
            raise ValueError("mounts that lie on the rail")
        return self


class OutputTable(Table):
    """``[output]``: sampling interval of every result (s)."""

    interval: PositiveTime = 5e-5


class AgreementTable(Table):
    """``[agreement]``: conditions that are fitted, those only scored, those that give the floor and the refinement error."""

    fitted: list[str] = Field(default_factory=list)
    held_out: list[str] = Field(default_factory=list)
    floor: list[str] = Field(default_factory=list)
    refined: list[str] = Field(default_factory=list)
