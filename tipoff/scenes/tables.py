"""The small tables of every scene: payload, pads, output, agreement."""

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, field_validator

from tipoff.scenes.body import InertiaTensor
from tipoff.scenes.table import Table, at_least_one, limited
from tipoff.scenes.units import (
    Length,
    Mass,
    NonNegativeLength,
    PositiveLength,
    PositiveNumber,
    PositiveRate,
    PositiveTime,
)

MOST_SAMPLES = 1_000_000  # after ignition: a gigabyte of curves
_ROUNDING = 1e-12  # relative: a last sample at the end of the scene is one

_Names = Annotated[tuple[str, ...], limited]
Normal = Literal["+y", "-y", "+z", "-z"]


class PayloadTable(Table):
    """``[payload]``: mass, inertia about the actual mass centre, and (for plausibility) outer
    size."""

    mass: Mass
    inertia: InertiaTensor
    size: tuple[PositiveLength, PositiveLength, PositiveLength] | None = None


class PadTable(Table):
    """``[[pads]]``: a pad on the payload; each normal is one flat face, crowned by ``relief`` at
    its edges.

    ``position`` is the pad's corner measured from the nominal mass centre. A face with normal along
    y is centred ``inset`` towards the payload's axis along z (and the other way round).
    """

    position: tuple[Length, Length, Length]
    normals: Annotated[tuple[Normal, ...], limited, AfterValidator(at_least_one)]
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


class OutputTable(Table):
    """``[output]``: sampling interval of every result (s). The outcome does not depend on it."""

    interval: PositiveTime = 5e-5

    def fits(self, duration: float) -> bool:
        """Whether a scene that lasts ``duration`` (s) has at least one sample after ignition, and
        no more than MOST_SAMPLES."""
        return 1 <= duration / self.interval * (1.0 + _ROUNDING) < MOST_SAMPLES + 1

    def last(self, duration: float) -> int:
        """Number of the last sample of a scene that lasts ``duration`` (s), the one at ignition
        being number 0."""
        return int(duration / self.interval * (1.0 + _ROUNDING))


class AgreementTable(Table):
    """``[agreement]``: conditions that are fitted, held out, used for the floor, and refined;
    and the limits of agreement: relative L2 of the rates (1) and error of a settled rate (rad/s)."""

    fitted: _Names = ()
    held_out: _Names = ()
    floor: _Names = ()
    refined: _Names = ()
    rate_limit: PositiveNumber = 0.05
    settled_limit: PositiveRate = math.radians(0.1)
