"""A measured thrust curve: reading, checking, and its least-squares Gaussian fit."""

import math
import warnings
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.files import read_input
from tipoff.formats.instrument_table import scale
from tipoff.formats.thrusts.reader import read_thrust
from tipoff.formats.thrusts.record import ANYTHING, SECTION, Choice, Record

FIT_IMPULSE = 0.02  # of the impulse of a curve: largest error of its fit by default
_HIGHEST = 2.0  # times the largest measured force: the peak of a Gaussian that describes a curve
_LATE, _LATE_LENGTHS = 10.0, 10.0  # s, and lengths of a record, before its first point


class MeasuredCurve(NamedTuple):
    """A measured curve of n >= 2 points. A repeated time is a jump, from the first force to the
    second."""

    time: np.ndarray  # (n,) s, >= 0, increasing
    force: np.ndarray  # (n,) N


class GaussianFit(NamedTuple):
    """Least-squares Gaussian of a measured curve."""

    peak: float  # N
    centre: float  # s
    width: float  # s
    relative_residual: float  # L2
    impulse: float  # N s, of the fit
    curve_impulse: float  # N s

    @property
    def impulse_error(self) -> float:
        """Relative error of the effective impulse: of the Gaussian after ignition, where a scene
        begins."""
        before = 0.5 * math.erfc(self.centre / (math.sqrt(2.0) * self.width))
        return self.impulse * (1.0 - before) / self.curve_impulse - 1.0


def read_curve(path: str | Path, choice: Choice = ANYTHING) -> MeasuredCurve:
    """Read a thrust over time (``read_record``)."""
    return read_record(path, choice)[0]


def read_record(
    path: str | Path, choice: Choice = ANYTHING, may_begin_early: bool = False
) -> tuple[MeasuredCurve, str]:
    """The thrust over time in a file of a format in ``tipoff.formats.thrusts``, and what was
    read in words. A time in two points is a jump; times are negative only if the curve
    ``may_begin_early``. Raises ValueError with what is wrong."""
    try:
        data = read_input(path)
    except OSError as error:
        raise ValueError(f"a readable CSV file ({error.strerror or error})") from error
    curve, words = _parsed(str(path), data, choice, may_begin_early)
    return MeasuredCurve(*(values.copy() for values in curve)), words


def curve_of_points(
    points: Sequence[tuple[float, float]], choice: Choice, may_begin_early: bool = False
) -> MeasuredCurve:
    """The thrust over time of n >= 2 ``points`` (time, force), in the units of ``choice``. Raises
    ValueError with what is wrong, as ``read_record`` does."""
    choice.require_only(("time_unit", "thrust_unit"), "points")
    units = {"time_unit": choice.time_unit, "thrust_unit": choice.thrust_unit}
    if missing := [f"thrust.{name}" for name, unit in units.items() if unit is None]:
        raise ValueError(f"points with {' and '.join(missing)}")
    factors = [scale(unit or "", si) for unit, si in zip(units.values(), ("s", "N"))]
    time, force = (np.array(points, dtype=float).reshape(-1, 2) * factors).T.copy()
    found = Record(time, force, "", tuple(range(1, len(time) + 1)), counted="point")
    return _checked(found, may_begin_early)


# Each condition and each variation of a scene reads its curve. Equal bytes give an equal curve.
@lru_cache(maxsize=4)
def _parsed(
    path: str, data: bytes, choice: Choice, may_begin_early: bool
) -> tuple[MeasuredCurve, str]:
    found = read_thrust(path, data, choice)
    return _checked(found, may_begin_early), found.words


def _checked(found: Record, may_begin_early: bool) -> MeasuredCurve:
    """The curve of a record. Raises ValueError with everything that is wrong."""
    time, wrong = found.time, list(found.faults)
    for is_wrong, expected in _expected(found, may_begin_early):
        if is_wrong.any():
            wrong.append(f"{expected} ({found.where(is_wrong)})")
    if np.unique(time).size < 2:
        wrong.append("at least two different times")
    if wrong:
        raise ValueError(f"a curve with {', '.join(wrong)}; {SECTION}")
    return MeasuredCurve(time, found.force)


def _expected(found: Record, may_begin_early: bool) -> Iterator[tuple[np.ndarray, str]]:
    """Points (n,) of a record that are wrong, and what is expected of them."""
    time, force = found.time, found.force
    if not found.faults:  # which name numbers that could not be read
        yield ~(np.isfinite(time) & np.isfinite(force)), "finite numbers"
    if not may_begin_early:
        yield time < 0.0, "times that are not negative, or thrust.ignition where a scene begins"
    steps = np.diff(time, prepend=-np.inf)
    yield steps < 0.0, "times in increasing order"
    repeats = steps == 0.0
    again = repeats & np.append(False, repeats[:-1])
    yield again, "each time in at most two rows for a jump"
    if found.is_motor:
        yield force < 0.0, "thrusts of a motor that are not negative"


def is_of_a_clock(curve: MeasuredCurve) -> bool:
    """Whether the times seem to count from another instant than ignition: the first one is later
    than several times the length of the record."""
    first, last = float(curve.time[0]), float(curve.time[-1])
    return first > max(_LATE, _LATE_LENGTHS * (last - first))


def from_ignition(curve: MeasuredCurve, ignition: float | None) -> MeasuredCurve:
    """The curve from the instant ``ignition`` (s) on, which becomes zero. Raises ValueError for an
    instant outside the curve, and for a curve in the time of a clock without it."""
    if ignition is None and is_of_a_clock(curve):
        raise ValueError(
            f"times from ignition on, or thrust.ignition, the instant of the file at which the scene "
            f"begins (the file is from {curve.time[0]:.15g} s to {curve.time[-1]:.15g} s); {SECTION}"
        )
    if ignition is None:
        return curve
    if not curve.time[0] <= ignition < curve.time[-1]:
        raise ValueError(
            f"a curve around thrust.ignition = {ignition:.15g} s (it is from {curve.time[0]:.15g} s "
            f"to {curve.time[-1]:.15g} s); {SECTION}"
        )
    first = int(np.searchsorted(curve.time, ignition, side="right"))
    begun = float(
        np.interp(ignition, curve.time[first - 1 : first + 1], curve.force[first - 1 : first + 1])
    )
    return MeasuredCurve(
        np.concatenate([[0.0], curve.time[first:] - ignition]),
        np.concatenate([[begun], curve.force[first:]]),
    )


def without_baseline(curve: MeasuredCurve, baseline: tuple[float, float] | None) -> MeasuredCurve:
    """The curve minus the straight line from the first to the last value of the ``baseline`` (N),
    readings without thrust at the first and at the last time."""
    if baseline is None:
        return curve
    share = (curve.time - curve.time[0]) / (curve.time[-1] - curve.time[0])
    line = baseline[0] + (baseline[1] - baseline[0]) * share
    return MeasuredCurve(curve.time, curve.force - line)


def fit_gaussian(curve: MeasuredCurve) -> GaussianFit:
    """Least-squares Gaussian of a measured curve, started from its moments. Raises ValueError if
    there is none."""
    found = _fitted(*(np.asarray(values, dtype=float).tobytes() for values in curve))
    if isinstance(found, str):
        raise ValueError(found)
    return found


# A search that does not converge takes a second, and each condition of a scene needs the fit.
@lru_cache(maxsize=32)
def _fitted(times: bytes, forces: bytes) -> GaussianFit | str:
    """The fit of a curve by its bytes, or the reason why there is none."""
    time, force = np.frombuffer(times), np.frombuffer(forces)
    total = float(np.trapezoid(force, time))
    if time.size < 4 or total <= 0.0:
        return "a curve of at least four points and positive impulse, for a Gaussian to fit"

    def gaussian(t, peak, centre, width):
        return peak * np.exp(-0.5 * ((t - centre) / width) ** 2)

    centre = float(np.trapezoid(force * time, time) / total)
    width = math.sqrt(
        max(
            np.trapezoid(force * (time - centre) ** 2, time) / total,
            np.diff(np.unique(time)).min() ** 2,
        )
    )
    start = (total / (width * math.sqrt(2.0 * math.pi)), centre, width)
    try:
        with warnings.catch_warnings():
            # Warnings are about the covariance, which is not used; failed fits are found below.
            warnings.simplefilter("ignore", scipy.optimize.OptimizeWarning)
            (peak, centre, width), _ = scipy.optimize.curve_fit(
                gaussian, time, force, p0=start, maxfev=20000
            )
    except RuntimeError:
        return "a curve that a Gaussian fits (least squares did not converge)"
    peak, centre, width = float(peak), float(centre), abs(float(width))
    # The best fit of a flat curve is a very wide Gaussian, with thrust long after the burn.
    if not time[0] <= centre <= time[-1] or width > 0.5 * (time[-1] - time[0]):
        return (
            f"a curve that a Gaussian fits (found centre {centre:.4g} s, width {width:.4g} s, "
            f"for a curve from {time[0]:.4g} to {time[-1]:.4g} s)"
        )
    if not 0.0 < peak <= _HIGHEST * force.max():  # a needle between two points
        return (
            f"a curve that a Gaussian fits (found a peak of {peak:.4g} N, for a curve up to "
            f"{force.max():.4g} N)"
        )
    residual = np.linalg.norm(force - gaussian(time, peak, centre, width)) / np.linalg.norm(force)
    return GaussianFit(
        peak=peak,
        centre=centre,
        width=width,
        relative_residual=float(residual),
        impulse=peak * width * math.sqrt(2.0 * math.pi),
        curve_impulse=total,
    )
