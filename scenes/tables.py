"""The tables every scene has: payload, pads, rail, output, and what the agreement study fits and scores."""

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, ValidationInfo, field_validator

from scenes.body import InertiaTensor
from scenes.table import Table, at_least_one
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
    normals: Annotated[tuple[Normal, ...], AfterValidator(at_least_one)]
    length: PositiveLength = 0.016
    width: PositiveLength = 0.016
    inset: NonNegativeLength = 0.0
    relief: NonNegativeLength = 0.0

    @field_validator("normals")
    @classmethod
    def _different(cls, normals):
        if len(set(normals)) < len(normals):
            raise ValueError("each normal once")
        return normals


class Span(Table):
    """A stretch along the rail measured from its rear end (m)."""

    start: NonNegativeLength
    end: PositiveLength

    @field_validator("end")
    @classmethod
    def _forward(cls, end: float, info: ValidationInfo):
        if end <= info.data.get("start", -math.inf):
            raise ValueError("an end beyond start")
        return end


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
    mounts: tuple[Span, ...] = ()
    material: MaterialTable

    @field_validator("end")
    @classmethod
    def _forward(cls, end: float, info: ValidationInfo):
        if end <= info.data.get("start", -math.inf):
            raise ValueError("an end beyond start")
        return end

    @field_validator("thickness", "mount_width")
    @classmethod
    def _within_leg(cls, value: float, info: ValidationInfo):
        leg = info.data.get("leg", math.inf)
        if value > leg or (info.field_name == "thickness" and value == leg):
            raise ValueError(f"less than the leg, {leg:g} m")
        return value

    @field_validator("mounts")
    @classmethod
    def _apart_on_the_rail(cls, mounts: tuple[Span, ...], info: ValidationInfo):
        length = info.data.get("end", math.inf) - info.data.get("start", 0.0)
        if any(span.end > length + 1e-12 for span in mounts):
            raise ValueError(f"spans that lie on the rail, which is {length:g} m long")
        inward = sorted(mounts, key=lambda span: span.start)
        if any(after.start < before.end for before, after in zip(inward, inward[1:])):
            raise ValueError("spans that do not overlap")
        return mounts


class OutputTable(Table):
    """``[output]``: sampling interval of every result (s)."""

    interval: PositiveTime = 5e-5


class AgreementTable(Table):
    """``[agreement]``: conditions that are fitted, those only scored, those that give the floor and the refinement error."""

    fitted: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()
    floor: tuple[str, ...] = ()
    refined: tuple[str, ...] = ()
