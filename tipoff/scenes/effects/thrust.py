"""Thrust over time: Gaussian, a sum of Gaussians, a constant push, or a measured curve. A force over
travel is in ``spring``.

    F(t) = sum_i P_i exp(-(t - t_i)^2 / (2 s_i^2))   begin <= t <= end,        impulse of one pulse J = P s sqrt(2 pi)

A pulse cut at ``n`` widths keeps erf(n / sqrt 2) of its impulse; ``rescale`` restores it. A
measured curve is used point by point, or through its least-squares Gaussian fit; ``describe``
states which, with the fit, its residual and both impulses. The law is in ``thrust_law``; its names
are exported here too.
"""

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    PrivateAttr,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tipoff.scenes.effects.measured import (
    FIT_IMPULSE,
    GaussianFit,
    MeasuredCurve,
    fit_gaussian,
    read_curve,
    without_baseline,
)
from tipoff.scenes.effects.spring import SpringsTable, SpringTable
from tipoff.scenes.effects.thrust_law import (
    ROOT_TWO_PI,
    Curve,
    Pulses,
    Thrust,
    burnout,
    burnouts,
    corners,
    impulse,
    kept,
    magnitude,
    peak,
    sample,
    shortest_feature,
)
from tipoff.scenes.faults import within
from tipoff.scenes.rounding import below
from tipoff.scenes.table import Table, at_least_one, is_absent, limited
from tipoff.scenes.units import (
    Force,
    Impulse,
    NonNegativeNumber,
    NonNegativeTime,
    PositiveLength,
    PositiveNumber,
    PositiveTime,
    Time,
)

__all__ = [
    "Curve",
    "Pulse",
    "Pulses",
    "Thrust",
    "ThrustTable",
    "burnout",
    "burnouts",
    "corners",
    "impulse",
    "magnitude",
    "peak",
    "sample",
    "shortest_feature",
]


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


class _ThrustTable(Table):
    """Keys of every kind: ``arm`` (m), distance of the point of application behind the nominal mass
    centre; ``reaction``."""

    #: Distance of the point of application behind the nominal mass centre.
    arm: PositiveLength = 0.1
    #: "platform": the reaction acts on the platform; "exhaust": it leaves with the gas.
    reaction: Literal["platform", "exhaust"] = "platform"
    if TYPE_CHECKING:
        kind: str  # a literal in each kind, at the place of its key

    def record(self) -> Thrust:
        """Kernel record."""
        raise NotImplementedError

    def contents(self) -> tuple[dict, list[list[float]]]:
        """The table without paths, and the points of its file, for the hash of a scene."""
        return self.model_dump(mode="json"), []

    def middle(self) -> tuple[float, float]:
        """Place (m) of the line of action along Y and Z, without errors."""
        return (0.0, 0.0)

    def requested(self) -> float:
        """Impulse (N s) of the table."""
        raise NotImplementedError

    def describe(self, duration: float) -> dict[str, float | str]:
        """The thrust for results and report: numbers in SI by name, and a sentence, ``text``.

        ``impulse_requested_Ns`` is the impulse of the table, ``impulse_delivered_Ns`` the one within
        0..``duration`` (s).
        """
        record = self.record()
        requested, delivered = self.requested(), impulse(record, duration)
        text = (
            f"{self.kind}, {self.usage()}; impulse requested {requested:.7g} N s, delivered in the "
            f"scene {delivered:.7g} N s"
        )
        return {
            "kind": self.kind,
            "peak_N": peak(record, duration),
            "impulse_requested_Ns": requested,
            "impulse_delivered_Ns": delivered,
            **self.details(),
            "text": text,
        }

    def usage(self) -> str:
        """Text on how the table becomes F(t)."""
        return "used as given"

    def details(self) -> dict[str, float | str]:
        """Additions of this kind to ``describe``."""
        return {}


class _PulsedTable(_ThrustTable):
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


class ConstantTable(_ThrustTable):
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


class MeasuredTable(_ThrustTable):
    """``[thrust] kind = "measured"``: CSV with columns ``time_s,force_N``; ``use`` the curve itself
    or its Gaussian fit."""

    #: A measured curve.
    kind: Literal["measured"]
    #: CSV file with the columns time_s,force_N; relative to the scene file.
    file: str
    #: "curve": the points act; "fit": their Gaussian fit acts.
    use: Literal["curve", "fit"] = "curve"
    #: Largest relative error of the impulse of the fit, with use = "fit".
    fit_impulse_tolerance: NonNegativeNumber = FIT_IMPULSE
    #: Readings of the load cell without thrust, at the first and at the last point. The straight
    #: line between them is subtracted.
    baseline: tuple[Force, Force] | None = Field(None, exclude_if=is_absent)
    _curve: MeasuredCurve = PrivateAttr()

    @field_validator("file")
    @classmethod
    def _readable(cls, file: str):
        read_curve(file)
        return file

    @model_validator(mode="after")
    def _usable(self):
        self._curve = without_baseline(read_curve(self.file), self.baseline)
        if self.use == "fit":
            fit = fit_gaussian(self._curve)
            if below(self.fit_impulse_tolerance, abs(fit.impulse_error)):
                raise within(
                    "use",
                    f"'fit', whose impulse after ignition differs by {100.0 * fit.impulse_error:+.3g} % from "
                    f"the {fit.curve_impulse:.5g} N s of the curve, relative residual "
                    f"{100.0 * fit.relative_residual:.3g} %",
                    f"a difference of at most {100.0 * self.fit_impulse_tolerance:g} %: "
                    f'use = "curve", or a larger thrust.fit_impulse_tolerance',
                )
        return self

    def fit(self) -> GaussianFit | None:
        """Least-squares Gaussian of the curve, with residual and impulses; None if there is
        none."""
        try:
            return fit_gaussian(self._curve)
        except ValueError:
            return None

    def curve(self) -> MeasuredCurve:
        """Measured times (s) and forces (N), without the baseline."""
        return self._curve

    def contents(self) -> tuple[dict, list[list[float]]]:
        """The table without its path, with times (s) and forces (N) of the curve."""
        points = [self._curve.time.tolist(), self._curve.force.tolist()]
        return self.model_dump(mode="json", exclude={"file"}), points

    def record(self) -> Thrust:
        """Kernel record: the curve, or one pulse."""
        if self.use == "fit":
            fit = fit_gaussian(self._curve)
            pulses = Pulses(
                peaks=np.array([fit.peak]),
                centres=np.array([fit.centre]),
                widths=np.array([fit.width]),
                begin=-math.inf,
                end=math.inf,
            )
            return Thrust(pulses=pulses, curve=None)
        return Thrust(None, Curve(self._curve.time, self._curve.force))

    def requested(self) -> float:
        """Impulse (N s) of the measured curve, without the baseline."""
        return float(np.trapezoid(self._curve.force, self._curve.time))

    def usage(self) -> str:
        """Whether the points or the fit act, and their agreement."""
        acting = "the points act" if self.use == "curve" else "the Gaussian fit acts"
        fit = self.fit()
        if fit is None:
            return f"{acting}, no Gaussian fits"
        return (
            f"{acting}; fit peak {fit.peak:.6g} N, centre {fit.centre:.6g} s, width "
            f"{fit.width:.6g} s, relative residual "
            f"{fit.relative_residual:.3g}, impulse {fit.impulse:.7g} N s against "
            f"{fit.curve_impulse:.7g} N s of the curve"
        )

    def details(self) -> dict[str, float | str]:
        """Which of curve and fit is used, and the fit."""
        used: dict[str, float | str] = {"use": self.use}
        fit = self.fit()
        if fit is None:
            return used
        return used | {
            "fit_peak_N": fit.peak,
            "fit_centre_s": fit.centre,
            "fit_width_s": fit.width,
            "fit_relative_residual": fit.relative_residual,
            "fit_impulse_Ns": fit.impulse,
            "curve_impulse_Ns": fit.curve_impulse,
        }


ThrustTable = Annotated[
    GaussianTable | GaussiansTable | ConstantTable | MeasuredTable | SpringTable | SpringsTable,
    Field(discriminator="kind"),
]
