"""Readings of a load cell without thrust: the level before ignition and the one after burn-out."""

import math
from typing import NamedTuple

import numpy as np

from tipoff.scenes.effects.measured import MeasuredCurve

FEWEST = 5  # samples of a level
_BURNS = 0.05  # of the peak: above it there is thrust
_PLATEAU = 0.2  # of the peak: a higher level is thrust that the record cuts
_AGREE = 0.2  # relative difference of two points on one level
_CALM = 3.0  # standard deviations of the noise of a sample without thrust
_EARLY = 0.8  # share of the samples before a clear thrust that show the drift
_STILL = 1e-6  # of the peak: a smaller level or noise is rounding


class Level(NamedTuple):
    """Reading (N) at one end of a record."""

    value: float
    is_seen: bool  # above its scatter
    noise: float = 0.0  # N, standard deviation of one sample
    calm: int = 0  # samples without thrust, from this end on
    time: float = math.nan  # s, of the sample at which thrust begins or ends
    peak: float = 0.0  # N, of the whole record


Levels = tuple[Level | None, Level | None]


def levels(curve: MeasuredCurve) -> Levels:
    """The levels before ignition and after burn-out; None for a record that begins or ends with
    thrust."""
    peak = float(np.abs(curve.force).max())
    if peak == 0.0:
        return None, None
    before, after = _level(curve, peak), _level(MeasuredCurve(*(c[::-1] for c in curve)), peak)
    if before is None and after is None:
        before = after = _of_few_points(curve, peak)
    return before, after


def words(before: Level | None, is_removed: bool) -> str:
    """The level before ignition in words; empty if the record has none, or if it is zero without
    noise."""
    if before is None or max(abs(before.value), before.noise) <= _STILL * before.peak:
        return ""
    done = "subtracted" if is_removed else "kept"
    where = f"before ignition at {before.time:.4g} s" if before.calm else "at both ends"
    return f"reading {where} {before.value:.4g} N, noise {before.noise:.3g} N, {done}"


def without_offset(curve: MeasuredCurve, before: Level, after: Level | None) -> MeasuredCurve:
    """The curve minus the straight line from the level before ignition to the one after burn-out, or
    minus the first if there is no second. It is zero before ignition."""
    share = (curve.time - curve.time[0]) / (curve.time[-1] - curve.time[0])
    last = before.value if after is None else after.value
    force = curve.force - before.value - (last - before.value) * share
    force[: before.calm] = 0.0
    return MeasuredCurve(curve.time, force)


def _level(curve: MeasuredCurve, peak: float) -> Level | None:
    """The level of the first samples, if they are no thrust: at least ``FEWEST`` within 5 % of the
    ``peak`` about their median. None for a record that begins with thrust."""
    force = curve.force
    noise = 1.4826 * float(np.median(np.abs(np.diff(force)))) / math.sqrt(2.0)
    begun = float(np.median(force[: max(FEWEST, force.size // 100)]))
    burning = np.flatnonzero(
        np.abs(force - begun) > np.clip(6.0 * noise, _BURNS * peak, _PLATEAU * peak)
    )
    count = int(burning[0]) if burning.size else force.size
    if count < FEWEST or abs(begun) > _PLATEAU * peak:
        return None
    level, error = _mean(force[: max(FEWEST, count // 2)])
    quiet = 1.4826 * float(np.median(np.abs(np.diff(force[:count])))) / math.sqrt(2.0)
    # Thrust begins before it is clearly above the noise about a zero that may drift.
    place, early = np.arange(count), max(FEWEST, int(_EARLY * count))
    drift = np.polyval(np.polyfit(place[:early], force[:early], 1), place)
    still = np.flatnonzero(np.abs(force[:count] - drift) <= _CALM * max(quiet, _STILL * peak))
    begun = int(still[-1]) + 1 if still.size else count
    return Level(
        level,
        abs(level) > 3.0 * error,
        noise=quiet,
        calm=begun,
        time=float(curve.time[min(begun, force.size - 1)]),
        peak=peak,
    )


def _mean(calm: np.ndarray) -> tuple[float, float]:
    """Level (N) at the beginning of samples (n,) without thrust, and its standard error. A zero
    that drifts along a straight line gives the start of the line, else it is the median. Thrust
    that begins or fades slowly has no straight line; the first samples are then used."""
    place = np.linspace(0.0, 1.0, calm.size)
    slope, end = np.polyfit(place, calm, 1)
    left = float(np.std(calm - slope * place - end))
    scatter = 1.4826 * float(np.median(np.abs(np.diff(calm, 2)))) / math.sqrt(6.0)
    error = 1.2533 * scatter / math.sqrt(calm.size)
    if left > 2.0 * scatter + 1e-9 * abs(end):
        few = calm[: max(FEWEST, calm.size // 5)]
        return float(np.median(few)), 1.2533 * float(np.std(few)) / math.sqrt(few.size)
    # The end of the line has twice the error of the mean.
    if abs(slope) > 4.0 * math.sqrt(12.0) * error:
        return float(end), 2.0 * error
    return float(np.median(calm)), error


def _of_few_points(curve: MeasuredCurve, peak: float) -> Level | None:
    """The level of a record with too few points for a level at each end, if its first and last
    point agree and are no thrust."""
    first, last = float(curve.force[0]), float(curve.force[-1])
    agree = first * last > 0.0 and abs(first - last) <= _AGREE * abs(last)
    if not agree or abs(last) > _PLATEAU * peak:
        return None
    return Level(0.5 * (first + last), True, peak=peak)
