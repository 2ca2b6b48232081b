"""Reads the log of an inertial unit: units, an even time base, and notes on every repair.

Every sample belongs to an instant of an even grid. Samples whose time jitters by less than half an
interval are interpolated onto the grid. One or two samples that are missing or not a number are bridged
by a straight line. Longer gaps and clipped rates are marked, and a window that contains them is refused.
A channel that repeats one value more often than its noise allows is not measured either. A temperature
drifts slowly, so it is interpolated over gaps of any length. Each repair adds a note; anything worse is
a fault. Raw samples then become rates in payload body axes by the inverse of the sensor
model:

    raw = (1 + diag s)(1 + E) w + b + G f + c (T - T0)          sensor axes
    w_body = R [(1 + diag s)(1 + E)]^-1 (raw - b - G f - c (T - T0))

s scale errors, E misalignments (rad), b biases, G sensitivity to the specific force f, c drift with
temperature, R mounting.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.formats.logs.reader import read_log
from tipoff.studies.measured import sampling
from tipoff.studies.measured import sheet as sheets
from tipoff.studies.measured.frozen import frozen
from tipoff.studies.measured.quantisation import steps
from tipoff.studies.measured.saturation import saturated
from tipoff.studies.measured.sheet import LaunchSheet, SensorSheet, Sheet
from tipoff.workspace.words import counted

_FEWEST = 100  # samples
_BRIDGED = 2  # missing samples that a straight line may replace
_JITTER = 0.01  # of an interval: a smaller jitter is rounding of the clock and stays
_UNEVEN = 0.45  # of an interval: with more jitter the instant of a sample is not clear
_COARSER = 1.01  # steps in a log of few digits differ from the stated one by less
_MOST_MISSING = 10.0  # instants of the even grid per sample; a wrong time would make billions


class Frozen(NamedTuple):
    """First and last instant (s) of samples in which a channel repeats one value, as a ``fault``."""

    begin: float
    end: float
    fault: Fault

    def covers(self, time: np.ndarray) -> np.ndarray:
        """Whether each instant (n,) of ``time`` (s) is in the stretch."""
        return (time >= self.begin) & (time <= self.end)


class Log(NamedTuple):
    """time (n,) s, even; raw rate (n,3) rad/s, acceleration (n,3) m/s2 or None, in sensor axes;
    temperature (n,) K or None; samples that are ``doubtful`` (n,): not measured, or the rate
    clipped; those with ``clipped`` acceleration (n,); ``notes``; stretches in which a channel is
    ``frozen``."""

    time: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray | None
    temperature: np.ndarray | None
    doubtful: np.ndarray
    clipped: np.ndarray
    notes: list[str]
    frozen: tuple[Frozen, ...] = ()

    @property
    def interval(self) -> float:
        """Between samples (s)."""
        return float(self.time[1] - self.time[0])


def read(path: str | Path) -> tuple[Sheet | LaunchSheet, Log]:
    """A sheet and its log. The resolution of the sheet is the step that the log shows, if that is
    coarser. Raises SceneError listing every fault of either."""
    sheet = sheets.load(path)
    source = Path(path).parent / sheet.file
    values, notes = read_log(source, sheet.columns.names(), dict(sheet.units))
    if len(values["time"]) < _FEWEST:
        given = counted(len(values["time"]), "sample")
        raise _fault(str(source), given, f"at least {_FEWEST}", "file")
    stated = sheet.gyro.resolution
    axes = {"rate": steps(values["rate"], stated)}
    if "acceleration" in values:
        axes["acceleration"] = steps(values["acceleration"])
    if (step := float(axes["rate"].min())) > _COARSER * stated:
        if stated:
            notes.append(
                f"rate: the samples have steps of {np.degrees(step):.3g} deg/s, gyro.resolution is "
                f"{np.degrees(stated):.3g} deg/s: the steps of the samples count"
            )
        gyro = sheet.gyro.model_copy(update={"resolution": step})
        sheet = sheet.model_copy(update={"gyro": gyro})
    return sheet, _even(sheet, str(source), values, axes, notes)


def _even(
    sheet: Sheet | LaunchSheet,
    source: str,
    values: dict[str, np.ndarray],
    axes: dict[str, np.ndarray],
    notes: list[str],
) -> Log:
    """The log of ``values`` on an even grid; ``axes``: steps (3,) of the sensors by name."""
    time = values["time"][:, 0]
    place, start, interval = _places(sheet, source, values)
    off = np.abs(time - start - interval * place).max() / interval
    if off > _UNEVEN or (np.diff(place) == 0).any():
        given = f"samples up to {off:.2g} of an interval off an even grid"
        raise _fault(source, given, f"less than {_UNEVEN}")
    grid = start + interval * np.arange(place[-1] + 1)
    if off > _JITTER:
        notes.append(
            f"time jitters by up to {100.0 * off:.2g} % of an interval: interpolated onto an even grid"
        )
    else:
        time = grid[place]
    filled, doubtful, held = {"time": grid}, np.zeros(grid.size, dtype=bool), []
    for name, found in values.items():
        if name == "temperature":
            filled[name] = _drifting(values["time"][:, 0], found[:, 0], grid, source, notes)
        elif name != "time":
            every = sampling.every(found, place) if name == "acceleration" else 1
            filled[name], gone = _bridged((time, place), found, grid, name, every, notes)
            doubtful |= gone
            held += _held(sheet, source, name, (values["time"][:, 0], found), axes[name])
    return _marked(sheet, filled, axes, doubtful, notes)._replace(frozen=tuple(held))


def _held(
    sheet: Sheet | LaunchSheet,
    source: str,
    name: str,
    samples: tuple[np.ndarray, np.ndarray],
    step: np.ndarray,
) -> list[Frozen]:
    """Where the rates or the accelerations, ``samples`` with their times and with the ``step`` (3,) of
    each axis, are frozen. A value at which a channel is saturated is not frozen."""
    known = np.isfinite(samples[1]).all(axis=1)
    time, values = samples[0][known], samples[1][known]
    if name == "rate":
        names, unit, shown = sheet.columns.rate, "deg/s", values * np.degrees(1.0)
        largest = sheet.gyro.range
    else:
        assert sheet.columns.acceleration is not None and sheet.accelerometer is not None
        names, unit, shown = sheet.columns.acceleration, "m/s2", values
        largest = sheet.accelerometer.range
    at_end = saturated(values, largest, step)
    found = []
    for run in frozen(values, float(step.min())):
        if not at_end[run.begin, run.axis]:
            begin, end = float(time[run.begin]), float(time[run.end - 1])
            given = (
                f"{shown[run.begin, run.axis]:.6g} {unit} in each of "
                f"{run.end - run.begin} samples, {begin:.6g} to {end:.6g} s"
            )
            expected = (
                f"a value that changes: noise as elsewhere in the log allows at most "
                f"{run.allowed} equal samples in a row"
            )
            found.append(Frozen(begin, end, Fault(source, names[run.axis], given, expected)))
    return found


def _places(
    sheet: Sheet | LaunchSheet, source: str, values: dict[str, np.ndarray]
) -> tuple[np.ndarray, float, float]:
    """Instant (n,) of an even grid that each sample belongs to, and the grid's start and interval
    (s). Raises SceneError."""
    time = values["time"][:, 0]
    finite = np.isfinite(time)
    if not finite.all():
        given = f"{counted((~finite).sum(), 'sample')} without a time"
        raise _fault(source, given, "a time for every sample")
    steps = np.diff(time)
    if (steps <= 0.0).any():
        given = f"{counted((steps <= 0.0).sum(), 'sample')} not later than the one before"
        raise _fault(source, given, "times in increasing order")
    interval = float(np.median(steps))
    if not (time[-1] - time[0]) <= _MOST_MISSING * time.size * interval:
        gap = int(np.argmax(steps))
        raise _fault(
            source,
            f"a gap from {time[gap]:.6g} s to {time[gap + 1]:.6g} s, samples {interval:.3g} s apart",
            f"at most {_MOST_MISSING:g} times as many instants as samples",
        )
    # Counted step by step: jitter of the median would add up over the whole log.
    place = np.concatenate([[0], np.cumsum(np.round(steps / interval).astype(int))])
    interval, start = (
        float(value) for value in np.polynomial.Polynomial.fit(place, time, 1).convert().coef[::-1]
    )
    every = sampling.every(values["acceleration"], place) if "acceleration" in values else 1
    sampling.require(sheet, interval, every, source)
    return place, start, interval


def _fault(source: str, given: str, expected: str, column: str = "time") -> SceneError:
    return SceneError([Fault(source, column, given, expected)])


def _bridged(
    when: tuple[np.ndarray, np.ndarray],
    columns: np.ndarray,
    grid: np.ndarray,
    name: str,
    every: int,
    notes: list[str],
) -> tuple[np.ndarray, np.ndarray]:
    """Values (n,k) on the grid from samples at ``when``, times and instants of the grid, of which
    one in ``every`` has a value; and the samples (n,) of gaps too long to bridge; adds ``notes``."""
    time, place = when
    good = np.isfinite(columns).all(axis=1)
    missing = np.ones(grid.size, dtype=bool)
    missing[place[good]] = False
    if every > 1:
        notes.append(f"{name}: given in one of {every} samples, interpolated between")
    # Between two of its own samples a slow channel has nothing to miss.
    gaps = [gap for gap in runs(missing) if gap[1] - gap[0] >= every]
    short = [gap for gap in gaps if gap[1] - gap[0] < (_BRIDGED + 1) * every]
    long = [gap for gap in gaps if gap[1] - gap[0] >= (_BRIDGED + 1) * every]
    if short:
        notes.append(
            f"{name}: {counted(len(short), 'gap')} of one or two samples bridged by a straight line, the "
            f"first at "
            f"{grid[short[0][0]]:.6g} s"
        )
    gone = np.zeros(grid.size, dtype=bool)
    for begin, end in long:
        gone[begin:end] = True
        notes.append(
            f"{name}: {counted(end - begin, 'sample')} missing from {grid[begin]:.6g} s on: left out of every "
            f"window"
        )
    if not good.any():
        return np.full((grid.size, columns.shape[1]), np.nan), gone
    return np.column_stack(
        [np.interp(grid, time[good], column[good]) for column in columns.T]
    ), gone


def _drifting(time, values, grid, source: str, notes: list[str]) -> np.ndarray:
    """Temperature (n,) on the grid; a logger may sample it more slowly than rates. Raises
    SceneError for a column without a number."""
    good = np.isfinite(values)
    if not good.any():
        raise _fault(
            source,
            "no number in the column",
            "a temperature, or no such column in the sheet",
            "temperature",
        )
    if not good.all():
        known = time[good]
        longest = np.diff([time[0], *known, time[-1]]).max()
        notes.append(
            f"temperature: given in {good.sum()} of {good.size} samples, interpolated between and "
            f"held before the first "
            f"and after the last, over {longest:.3g} s at most"
        )
    return np.interp(grid, time[good], values[good])


def _marked(
    sheet: Sheet | LaunchSheet, filled: dict, axes: dict, doubtful: np.ndarray, notes: list[str]
) -> Log:
    rate, force, temperature = filled["rate"], filled.get("acceleration"), filled.get("temperature")
    at_end = saturated(rate, sheet.gyro.range, axes["rate"])
    clipped = np.zeros(len(at_end), dtype=bool)
    if at_end.any():
        where = _level(np.degrees(rate), at_end, np.degrees(sheet.gyro.range), "deg/s")
        notes.append(
            f"rate: {counted(at_end.any(axis=1).sum(), 'sample')} clipped at {where}: left out of "
            "every window"
        )
    if force is not None:
        assert sheet.accelerometer is not None  # every sheet with accelerations has it
        largest = sheet.accelerometer.range
        pushed = saturated(force, largest, axes["acceleration"])
        clipped = np.asarray(pushed.any(axis=1))
        if clipped.any():
            where = _level(force, pushed, largest, "m/s2")
            notes.append(f"acceleration: {counted(clipped.sum(), 'sample')} clipped at {where}")
    gone = doubtful | at_end.any(axis=1)
    return Log(
        filled["time"],
        rate,
        acceleration=force,
        temperature=temperature,
        doubtful=gone,
        clipped=clipped,
        notes=notes,
    )


def _level(values: np.ndarray, at_end: np.ndarray, largest: float, unit: str) -> str:
    """The range in words, or the level of the samples ``at_end`` if it is below the range."""
    level = float(np.median(np.abs(values[at_end])))
    if abs(level / largest - 1.0) < 0.02:
        return f"the range of {largest:.4g} {unit}"
    return f"{level:.6g} {unit}, below the range of {largest:.4g} {unit}"


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """First and one past the last place of every stretch of True in ``flags`` (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist()))


class Calibrated(NamedTuple):
    """time (n,) s; rate (n,3) rad/s and specific force (n,3) m/s2, or None, in body axes;
    temperature (n,) K or None."""

    time: np.ndarray
    rate: np.ndarray
    force: np.ndarray | None
    temperature: np.ndarray | None


def sensitivity(scale_error, misalignment) -> np.ndarray:
    """(1 + diag s)(1 + E), (3,3)."""
    return np.diag(1.0 + np.asarray(scale_error)) @ (np.eye(3) + np.asarray(misalignment))


def calibrated(sheet: SensorSheet, log: Log) -> Calibrated:
    """Rates and forces of a log, compensated and turned into body axes."""
    gyro, turn = sheet.gyro, sheet.mounting
    rate, force = log.rate - np.array(gyro.bias), None
    if log.acceleration is not None:
        assert sheet.accelerometer is not None  # every sheet with accelerations has it
        force = (log.acceleration - np.array(sheet.accelerometer.bias)) / (
            1.0 + np.array(sheet.accelerometer.scale_error)
        )
        rate = rate - force @ np.array(gyro.g_sensitivity).T
        force = force @ turn.T
    if log.temperature is not None:
        rate = rate - (log.temperature - gyro.reference_temperature)[:, None] * np.array(
            gyro.temperature
        )
    inverse = np.linalg.inv(sensitivity(gyro.scale_error, gyro.misalignment))
    return Calibrated(log.time, rate @ (turn @ inverse).T, force, log.temperature)


def missing_information(sheet: SensorSheet, log: Log) -> list[str]:
    """Coefficients of the sheet for which the log has no column, in words."""
    notes = []
    if log.acceleration is None and np.any(sheet.gyro.g_sensitivity):
        notes.append("g-sensitivity not compensated: the log has no accelerations")
    if log.temperature is None and np.any(sheet.gyro.temperature):
        notes.append("drift with temperature not compensated: the log has no temperature")
    return notes
