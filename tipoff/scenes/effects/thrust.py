"""Thrust over time: Gaussian, a sum of Gaussians, a constant push, or a measured curve. A force over
travel is in ``spring``.

    F(t) = sum_i P_i exp(-(t - t_i)^2 / (2 s_i^2))   begin <= t <= end,        impulse of one pulse J = P s sqrt(2 pi)

A pulse cut at ``n`` widths keeps erf(n / sqrt 2) of its impulse; ``rescale`` restores it. A
measured curve is in ``measured_table``. The law is in ``mechanics.laws.thrust``.
"""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tipoff.mechanics.laws.thrust import ROOT_TWO_PI, Curve, Pulses, Thrust, kept
from tipoff.scenes.effects.measured_table import MeasuredTable
from tipoff.scenes.effects.spring import SpringsTable, SpringTable
from tipoff.scenes.effects.timed import TimedTable
from tipoff.scenes.table import Table, at_least_one, limited
from tipoff.scenes.units import (
    Force,
    Impulse,
    NonNegativeTime,
    PositiveNumber,
    PositiveTime,
    Time,
)


class Pulse(Table):
    """One Gaussian: peak force (N) or impulse (N s), width sigma (s), centre (s)."""

    #: Peak force; either this or impulse.
    peak: Force | None = None
    #: Impulse of the whole pulse; either this or peak.
    impulse: Impulse | None = None
    #: Standard deviation of the Gaussian.
    width: PositiveTime
    #: Time of the peak.
    centre: Time

    @model_validator(mode="after")
    def _one_size(self):
        if (self.peak is None) == (self.impulse is None):
            raise ValueError("exactly one of peak and impulse")
        return self

    def height(self) -> float:
        """Peak force (N)."""
        return self.peak if self.peak is not None else self.impulse / (self.width * ROOT_TWO_PI)

    def size(self) -> float:
        """Impulse (N s) of the whole, uncut pulse."""
        return self.height() * self.width * ROOT_TWO_PI


class _PulsedTable(TimedTable):
    """Gaussians, cut at ``cutoff`` widths before the first begins and after the last ends (absent:
    not cut).

    ``rescale`` increases each pulse by the share that the cut removes, so that the impulse is kept.
    """

    #: Number of widths beyond which pulses are cut; not cut where absent.
    cutoff: PositiveNumber | None = None
    #: Restores the impulse that the cut removes.
    rescale: bool = False

    @field_validator("rescale")
    @classmethod
    def _only_when_cut(cls, rescale: bool, info: ValidationInfo):
        if rescale and "cutoff" in info.data and info.data["cutoff"] is None:
            raise ValueError("a cutoff too: rescale restores the impulse that the cutoff removes")
        return rescale

    def pulses(self) -> tuple[Pulse, ...]:
        """The Gaussians, at least one."""
        raise NotImplementedError

    def record(self) -> Thrust:
        """Kernel record."""
        pulses = self.pulses()
        begin, end = -math.inf, math.inf
        if self.cutoff:
            begin = min(p.centre - self.cutoff * p.width for p in pulses)
            end = max(p.centre + self.cutoff * p.width for p in pulses)
        factors = [
            1.0 / kept(begin, end, p.centre, p.width) if self.rescale else 1.0 for p in pulses
        ]
        rows = np.array(
            [(p.height() * factor, p.centre, p.width) for p, factor in zip(pulses, factors)]
        )
        peaks, centres, widths = (np.ascontiguousarray(column) for column in rows.T)
        return Thrust(
            pulses=Pulses(peaks=peaks, centres=centres, widths=widths, begin=begin, end=end),
            curve=None,
        )

    def requested(self) -> float:
        """Impulse (N s) of the uncut pulses."""
        return float(sum(pulse.size() for pulse in self.pulses()))

    def usage(self) -> str:
        """Whether the pulses are cut, and whether their impulse is restored."""
        if not self.cutoff:
            return "not cut"
        return f"cut at {self.cutoff:g} widths and {'rescaled' if self.rescale else 'not rescaled'}"

    def details(self) -> dict[str, float | str]:
        """Cut of the pulses (widths), and whether they are rescaled."""
        return {"cutoff_widths": self.cutoff or "none", "rescaled": "yes" if self.rescale else "no"}


class GaussianTable(Pulse, _PulsedTable):
    """``[thrust] kind = "gaussian"``: the keys of one pulse and those of a pulsed thrust."""

    #: One Gaussian pulse.
    kind: Literal["gaussian"]

    def pulses(self) -> tuple[Pulse, ...]:
        """The only pulse, which is the table itself."""
        return (self,)


class GaussiansTable(_PulsedTable):
    """``[thrust] kind = "gaussians"`` with ``[[thrust.components]]``, one pulse each."""

    #: A sum of Gaussian pulses.
    kind: Literal["gaussians"]
    #: The pulses.
    components: Annotated[tuple[Pulse, ...], limited, AfterValidator(at_least_one)]

    def pulses(self) -> tuple[Pulse, ...]:
        """The components."""
        return self.components


class ConstantTable(TimedTable):
    """``[thrust] kind = "constant"``: force (N) from ``start`` for ``duration`` (s)."""

    #: A constant push.
    kind: Literal["constant"]
    #: Force.
    force: Force
    #: Time at which the push begins.
    start: NonNegativeTime = 0.0
    #: Duration of the push.
    duration: PositiveTime

    def record(self) -> Thrust:
        """Kernel record: a curve that jumps on and off."""
        times = np.array(
            [self.start, self.start, self.start + self.duration, self.start + self.duration]
        )
        return Thrust(None, Curve(times, np.array([0.0, self.force, self.force, 0.0])))

    def requested(self) -> float:
        """Impulse (N s) of the whole push."""
        return self.force * self.duration


ThrustTable = Annotated[
    GaussianTable | GaussiansTable | ConstantTable | MeasuredTable | SpringTable | SpringsTable,
    Field(discriminator="kind"),
]
