"""Thrust of the solid thruster: Gaussian, a sum of Gaussians, a constant push, or a measured curve.

    F(t) = sum_i P_i exp(-(t - t_i)^2 / (2 s_i^2))   begin <= t <= end,        impulse of one pulse J = P s sqrt(2 pi)

A pulse cut at ``n`` widths keeps erf(n / sqrt 2) of its impulse; ``rescale`` restores it. A measured curve is used point by
point, or through its least-squares Gaussian fit; the fit, its residual and its impulse are reported either way.
"""

import math
from typing import Annotated, Literal, NamedTuple, Union

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from scenes.effects.measured import MeasuredCurve, fit_gaussian, read_curve
from scenes.jit import njit
from scenes.table import Table
from scenes.units import Force, Impulse, NonNegativeTime, PositiveLength, PositiveNumber, PositiveTime, Time

_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


class Pulse(Table):
    """One Gaussian: peak force (N) or impulse (N s), width sigma (s), centre (s)."""

    peak: Force | None = None
    impulse: Impulse | None = None
    width: PositiveTime
    centre: Time

    @model_validator(mode="after")
    def _one_size(self):
        if (self.peak is None) == (self.impulse is None):
            raise ValueError("exactly one of peak and impulse")
        return self

    def height(self) -> float:
        """Peak force (N)."""
        return self.peak if self.peak is not None else self.impulse / (self.width * _ROOT_TWO_PI)


class _ThrustTable(Table):
    arm: PositiveLength = 0.1
    reaction: Literal["platform", "exhaust"] = "platform"


class _PulsedTable(_ThrustTable):
    """Gaussians; ``cutoff`` is the number of widths kept each side of a centre (absent: all), ``rescale`` keeps the impulse."""

    cutoff: PositiveNumber | None = None
    rescale: bool = False

    def record(self) -> "Thrust":
        pulses = self.pulses()
        factor = 1.0 / math.erf(self.cutoff / math.sqrt(2.0)) if self.cutoff and self.rescale else 1.0
        begin, end = -math.inf, math.inf
        if self.cutoff:
            begin = min(p.centre - self.cutoff * p.width for p in pulses)
            end = max(p.centre + self.cutoff * p.width for p in pulses)
        array = np.array([(p.height() * factor, p.centre, p.width) for p in pulses])
        return Thrust(Pulses(*(np.ascontiguousarray(column) for column in array.T), begin, end), None)


class GaussianTable(Pulse, _PulsedTable):
    """``[thrust] kind = "gaussian"``."""

    kind: Literal["gaussian"]

    def pulses(self) -> list[Pulse]:
        return [self]


class GaussiansTable(_PulsedTable):
    """``[thrust] kind = "gaussians"`` with ``[[thrust.pulses]]``."""

    kind: Literal["gaussians"]
    components: list[Pulse] = Field(min_length=1)

    def pulses(self) -> list[Pulse]:
        return self.components


class ConstantTable(_ThrustTable):
    """``[thrust] kind = "constant"``: force (N) from ``start`` for ``duration`` (s)."""

    kind: Literal["constant"]
    force: Force
    start: NonNegativeTime = 0.0
    duration: PositiveTime

    def record(self) -> "Thrust":
        times = np.array([self.start, self.start, self.start + self.duration, self.start + self.duration])
        return Thrust(None, Curve(times, np.array([0.0, self.force, self.force, 0.0])))


class MeasuredTable(_ThrustTable):
    """``[thrust] kind = "measured"``: CSV with columns ``time_s,force_N``; ``use`` the curve itself or its Gaussian fit."""

    kind: Literal["measured"]
    file: str
    use: Literal["curve", "fit"] = "curve"
    _curve: MeasuredCurve = PrivateAttr()

    @model_validator(mode="after")
    def _readable(self):
        self._curve = read_curve(self.file)
        return self

    def fit(self):
        """Least-squares Gaussian of the curve, with residual and impulses."""
        return fit_gaussian(self._curve)

    def record(self) -> "Thrust":
        if self.use == "fit":
            fit = self.fit()
            one = (np.array([value]) for value in (fit.peak, fit.centre, fit.width))
            return Thrust(Pulses(*one, -math.inf, math.inf), None)
        return Thrust(None, Curve(self._curve.time, self._curve.force))


ThrustTable = Annotated[Union[GaussianTable, GaussiansTable, ConstantTable, MeasuredTable], Field(discriminator="kind")]


class Pulses(NamedTuple):
    """Gaussians: peaks (N), centres (s), widths (s), each (n,), zero outside begin..end (s)."""

    peaks: np.ndarray
    centres: np.ndarray
    widths: np.ndarray
    begin: float
    end: float


class Curve(NamedTuple):
    """Piecewise linear curve: times (s, not decreasing; a repeated time is a jump) and forces (N)."""

    times: np.ndarray
    forces: np.ndarray


class Thrust(NamedTuple):
    """Kernel record: exactly one of the two is not None."""

    pulses: Pulses | None
    curve: Curve | None


@njit
def _pulsed(pulses, time):
    if not pulses.begin <= time <= pulses.end:
        return 0.0
    total = 0.0
    for i in range(pulses.peaks.size):
        x = (time - pulses.centres[i]) / pulses.widths[i]
        total += pulses.peaks[i] * np.exp(-0.5 * x * x)
    return total


@njit
def _interpolated(curve, time):
    last = curve.times.size - 1
    if time < curve.times[0] or time >= curve.times[last]:
        return 0.0
    after = np.searchsorted(curve.times, time, side="right")
    t0, t1 = curve.times[after - 1], curve.times[after]
    f0, f1 = curve.forces[after - 1], curve.forces[after]
    return f0 + (f1 - f0) * (time - t0) / (t1 - t0)


@njit
def magnitude(pulses, curve, time):
    """Thrust (N) at ``time`` (s). At a jump of a curve the value after the jump is taken."""
    force = 0.0
    if pulses is not None:
        force = _pulsed(pulses, time)
    if curve is not None:
        force = _interpolated(curve, time)
    return force


def corners(thrust: Thrust, duration: float) -> np.ndarray:
    """Sorted times (s) inside (0, duration) where F or its slope jumps: an integrator must stop there."""
    times = thrust.curve.times if thrust.curve is not None else np.array([thrust.pulses.begin, thrust.pulses.end])
    return np.unique(times[(times > 0.0) & (times < duration)])


def shortest_feature(thrust: Thrust) -> float:
    """Time scale (s) no step may jump over: the narrowest pulse width, or the shortest segment of a curve."""
    if thrust.pulses is not None:
        return float(thrust.pulses.widths.min())
    return float(np.diff(np.unique(thrust.curve.times)).min())


def sample(thrust: Thrust, time: np.ndarray) -> np.ndarray:
    """Thrust (N) at each of ``time`` (s)."""
    return np.array([magnitude(thrust.pulses, thrust.curve, t) for t in np.asarray(time, dtype=float)])


def burnout(thrust: Thrust, fraction: float, duration: float) -> float:
    """Earliest time (s) after which thrust stays below ``fraction`` of its peak; ``duration`` if that is later."""
    time = np.linspace(0.0, duration, 20001)
    force = np.abs(sample(thrust, time))
    above = np.flatnonzero(force >= fraction * force.max()) if force.max() > 0.0 else np.array([], dtype=int)
    return 0.0 if above.size == 0 else float(time[min(above[-1] + 1, time.size - 1)])


def impulse(thrust: Thrust, duration: float) -> float:
    """Impulse (N s) delivered in 0..duration: exact for both kinds."""
    if thrust.pulses is not None:
        p = thrust.pulses
        upper, lower = min(duration, p.end), max(0.0, p.begin)
        def erf(x, i):
            return math.erf((x - p.centres[i]) / (math.sqrt(2.0) * p.widths[i]))
        return float(sum(0.5 * p.peaks[i] * p.widths[i] * _ROOT_TWO_PI * (erf(upper, i) - erf(lower, i))
                         for i in range(p.peaks.size)))
    t, f = thrust.curve.times, thrust.curve.forces
    inside = t <= duration
    return float(np.trapezoid(f[inside], t[inside]))
