"""The small tables of every scene: payload, pads, output, agreement."""

import math
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, field_validator

from tipoff.mechanics.run_limits import MOST_SAMPLES
from tipoff.scenes.body import InertiaTensor
from tipoff.scenes.rounding import ROUNDING, below
from tipoff.scenes.table import Table, at_least_one, is_absent, limited
from tipoff.scenes.units import (
    Length,
    Mass,
    NonNegativeLength,
    PositiveLength,
    PositiveNumber,
    PositiveRate,
    PositiveTime,
)

_Names = Annotated[tuple[str, ...], limited]


def _along_an_axis(normal: Any) -> Any:
    """A triangle of three walls with the play c each is 3 c to 3.5 c wide, four walls 2 c."""
    if isinstance(normal, str) and normal not in get_args(_AXIAL):
        raise ValueError(
            "'+y', '-y', '+z' or '-z': walls face along Y or Z; for a tower of three rods at 120 deg take "
            "four walls at 90 deg, once with its play and once with 1.7 of it"
        )
    return normal


_AXIAL = Literal["+y", "-y", "+z", "-z"]
Normal = Annotated[_AXIAL, BeforeValidator(_along_an_axis)]


class BoxTable(Table):
    """A box between two corners in scene axes (m); it is flat if two coordinates are equal."""

    #: Corner with the smallest coordinates, in scene axes.
    low: tuple[Length, Length, Length]
    #: Corner with the largest coordinates, in scene axes.
    high: tuple[Length, Length, Length]

    @field_validator("high")
    @classmethod
    def _above(cls, high, info: ValidationInfo):
        if any(below(above, least) for least, above in zip(info.data.get("low", high), high)):
            raise ValueError("a corner whose coordinates are at least those of low")
        return high


class PayloadTable(Table):
    """``[payload]``: mass, inertia about the actual mass centre, and outer size (for
    plausibility)."""

    #: Mass of the payload.
    mass: Mass
    #: Inertia about the actual mass centre.
    inertia: InertiaTensor
    #: Outer size along x, y and z. It is used for plausibility and, without flight.body, for
    #: the clearance in flight.
    size: tuple[PositiveLength, PositiveLength, PositiveLength] | None = None
    #: Length of a body of which only this, diameter and mass are known: its size and, where absent,
    #: its inertia follow.
    length: PositiveLength | None = Field(None, exclude=True)
    #: Diameter of such a body. A rail with buttons or lugs lies below it.
    diameter: PositiveLength | None = Field(None, exclude=True)
    #: Place of the mass centre, from the origin of the scene.
    mass_centre: NonNegativeLength | None = Field(None, exclude=True)


class PadTable(Table):
    """``[[pads]]``: a pad on the payload; each normal is one flat face, crowned by ``relief`` at
    its edges.

    ``position`` is the pad's corner relative to the nominal mass centre. A face with normal along y
    is centred ``inset`` towards the payload's axis along z, a face with normal along z, along y.
    """

    #: Corner of the pad, from the nominal mass centre.
    position: tuple[Length, Length, Length]
    #: Outward normals of the faces: "+y", "-y", "+z" or "-z", each once.
    normals: Annotated[tuple[Normal, ...], limited, AfterValidator(at_least_one)]
    #: Length of a face along X.
    length: PositiveLength = 0.016
    #: Width of a face across the rail.
    width: PositiveLength = 0.016
    #: Distance from the corner to the middle of a face, along the face and towards the axis.
    inset: NonNegativeLength = 0.0
    #: Crown: how far the edges of a face lie behind its middle.
    relief: NonNegativeLength = 0.0
    #: Where the part that carries the face is fixed to the payload, from the nominal mass centre. Pads of
    #: one foot are one button or lug: its largest force is that of all of them, and has a moment about the foot.
    foot: tuple[Length, Length, Length] | None = Field(None, exclude_if=is_absent)

    @field_validator("normals")
    @classmethod
    def _different(cls, normals):
        if len(set(normals)) < len(normals):
            raise ValueError("each normal once")
        return normals


class OutputTable(Table):
    """``[output]``: sampling interval of every result (s). The outcome does not depend on it."""

    #: Sampling interval of every result. Exit and settled values do not depend on it.
    interval: PositiveTime = 5e-5

    def fits(self, duration: float) -> bool:
        """Whether a scene of ``duration`` (s) has at least one sample after ignition, and at most
        MOST_SAMPLES."""
        return 1 <= duration / self.interval * (1.0 + ROUNDING) < MOST_SAMPLES + 1

    def last(self, duration: float) -> int:
        """Number of the last sample of a scene of ``duration`` (s); the sample at ignition has
        number 0."""
        return int(duration / self.interval * (1.0 + ROUNDING))


class AgreementTable(Table):
    """``[agreement]``: conditions that are fitted, held out, used for the floor, and refined;
    and the limits of agreement: relative L2 of the rates (1) and error of a settled rate (rad/s)."""

    #: Conditions that the calibration uses.
    fitted: _Names = ()
    #: Conditions that the calibration does not use.
    held_out: _Names = ()
    #: Conditions whose change by 1 um of clearance is measured.
    floor: _Names = ()
    #: Conditions whose uncertainty by mesh, step and contact cells is measured.
    refined: _Names = ()
    #: Largest relative L2 difference of the rates where models agree.
    rate_limit: PositiveNumber = 0.05
    #: Largest difference of a settled rate where models agree.
    settled_limit: PositiveRate = math.radians(0.1)
