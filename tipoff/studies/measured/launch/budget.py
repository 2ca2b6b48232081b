"""Uncertainty of a reduced launch, according to the GUM.

An error of the measured acceleration moves the way by dx and the speed by dv. If the exit is where the way
reaches the travel, it moves by

    dt = -dx / v,   and the speed at the exit by   dv + a dt

| part | error | kind |
|---|---|---|
| scale | u(s), and a misaligned axis: u(E)^2 / 2 | B |
| bias | mean of the specific force at rest: sigma sqrt(tau / n) | A |
| start | an interval and a half (rectangular, ``SPAN``), in which the force may have risen | B |
| noise | white noise of the force, integrated once and twice | A |
| integration | a third of the change with every second sample (Richardson) | B |
| travel | stated | B |
| exit | of an exit that does not follow from the way | A |

A rate at the exit has the noise of the line after it and of the mean at rest, and the parts of a drop test
(``studies.measured.reduction``). Its part ``instant`` is the slope times the uncertainty of the exit and of
the delay between rates and accelerations.
"""

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from tipoff.studies.measured.launch.record import Record, scatter, travelled
from tipoff.studies.measured.log import Calibrated
from tipoff.studies.measured.reduction import (
    COVERAGE,
    correlation_time,
    instability_variance,
    quantised,
)
from tipoff.studies.measured.sheet import LaunchSheet

# Intervals in which the force may have risen before the first sample that shows it: one before it if a sample is the
# force at its instant, half of one before to half of one behind it if a sample is the mean over its interval.
SPAN = (-1.0, 0.5)
CLEAR = 2.0  # standard uncertainties of the exit after which the line begins


class Moved(NamedTuple):
    """Standard uncertainty by one part: of the instant of the exit (s of the log), of the time since the start
    (s) and of the speed (m/s)."""

    instant: float
    time: float
    speed: float


class Motion(NamedTuple):
    """Specific force ``along`` the rail (n,) m/s2 less that at rest, in the window at ``rest``, a mask (n,); the
    instants ``time`` (n,) s from the start; ``interval`` between samples (s)."""

    time: np.ndarray
    along: np.ndarray
    rest: np.ndarray
    interval: float


def of_motion(
    sheet: LaunchSheet, found: Motion, left: float, spread: float | None = None
) -> dict[str, Moved]:
    """Standard uncertainties by part of an exit at ``left`` (s from the start); ``spread``: that of an exit that
    does not follow from the way (s)."""
    speed, way = travelled(found.time, found.along)
    at = [float(np.interp(left, found.time, values)) for values in (way, speed, found.along)]
    moving = found.time > 0.0
    rise, step = float(found.along[moving][0]), (SPAN[1] - SPAN[0]) * found.interval / np.sqrt(12.0)
    rest = found.along[found.rest]
    tau = correlation_time([(rest - rest.mean())[:, None]])
    bias = float(rest.std(ddof=1)) * np.sqrt(tau / rest.size)
    assert sheet.accelerometer is not None and sheet.accelerometer.scale_uncertainty is not None
    scale = np.hypot(
        sheet.accelerometer.scale_uncertainty, 0.5 * sheet.gyro.uncertainty.misalignment**2
    )
    # every second sample from the first one on the rail
    coarse = travelled(found.time[moving][::2], found.along[moving][::2])
    fine = travelled(found.time[moving], found.along[moving])
    change = [
        abs(float(np.interp(left, found.time[moving][::2], few)) - _at(left, found, every)) / 3.0
        for few, every in zip(coarse[::-1], fine[::-1])
    ]
    errors = {
        "scale": (scale * at[0], scale * at[1], 0.0),
        "bias": (0.5 * bias * left**2, bias * left, 0.0),
        "start": (rise * step * left, rise * step, -step),
        "integration": (change[0], change[1], 0.0),
    }
    if spread is None:
        errors["travel"] = (sheet.launch.travel_uncertainty, 0.0, 0.0)
    parts = {}
    for name, (moved, faster, later) in errors.items():
        shift = 0.0 if spread is not None else -moved / at[1]
        parts[name] = Moved(abs(shift), abs(shift - later), abs(faster + at[2] * shift))
    parts["noise"] = _by_noise(found, left, (at[1], at[2]), spread is None)
    if spread is not None:
        parts["exit"] = Moved(spread, spread, abs(at[2]) * spread)
    return parts


def _at(left: float, found: Motion, values: np.ndarray) -> float:
    return float(np.interp(left, found.time[found.time > 0.0], values))


def _by_noise(found: Motion, left: float, at: tuple[float, float], is_way: bool) -> Moved:
    """By white noise of the force. The motor shakes the sensor: its noise is that after the exit, if larger."""
    speed, along = at
    rest = found.along[found.rest].std(ddof=1)
    after = found.along[found.time > left]
    # by the median, which a single change of the thrust does not move
    rough = np.median(np.abs(np.diff(after, 2))) if after.size > 4 else 0.0
    shaken = 1.4826 * rough / np.sqrt(6.0)
    density = float(max(rest, shaken)) ** 2 * found.interval
    faster, moved, both = density * left, density * left**3 / 3.0, density * left**2 / 2.0
    if not is_way:
        return Moved(0.0, 0.0, np.sqrt(faster))
    share = along / speed
    change = faster + share**2 * moved - 2.0 * share * both
    shift = np.sqrt(moved) / speed
    return Moved(shift, shift, np.sqrt(max(change, 0.0)))


def combined(parts: dict[str, Moved]) -> Moved:
    """All parts together."""
    return Moved(*np.sqrt((np.array(list(parts.values())) ** 2).sum(axis=0)).tolist())


class Rates(NamedTuple):
    """Rates (3,) rad/s at the exit; ``parts``: standard uncertainties (3,) by name; ``factor`` (3,) of
    expansion."""

    rate: np.ndarray
    parts: dict[str, np.ndarray]
    combined: np.ndarray
    factor: np.ndarray


def of_rates(
    sheet: LaunchSheet, samples: Calibrated, own: Record, rest: np.ndarray, instant: float
) -> Rates:
    """The rates at the exit, whose ``instant`` has a standard uncertainty (s) in the log."""
    unsure = float(np.hypot(instant, sheet.launch.delay_uncertainty))
    begin = own.left + CLEAR * unsure
    rate, line, slope = own.line(begin)
    free = own.free(begin)
    left = scatter(own.time[free], own.rate[free])
    tau = correlation_time([left], 2)
    calm = samples.rate[rest] - samples.rate[rest].mean(axis=0)
    tau_at_rest = correlation_time([calm])
    away = own.time[free] - own.time[free].mean()
    weights = np.zeros(own.time.size)
    weights[rest] = -1.0 / rest.sum()
    weights[free] = 1.0 / free.sum() + (own.left - own.time[free].mean()) * away / (away**2).sum()
    sure = sheet.gyro.uncertainty
    assert samples.force is not None
    pushed = np.linalg.norm(samples.force[free].mean(axis=0) - samples.force[rest].mean(axis=0))
    parts = {
        "noise after the exit": line * np.sqrt(tau),
        "noise at rest": own.rest_noise * np.sqrt(tau_at_rest / rest.sum()),
        "bias instability": np.full(
            3,
            np.sqrt(instability_variance(weights, own.interval, sure.bias_instability)),
        ),
        "scale": sure.scale * np.abs(rate),
        "misalignment": sure.misalignment * np.sqrt((rate**2).sum() - rate**2),
        "g-sensitivity": np.full(3, sure.g_sensitivity * pushed),
        "quantisation": quantised(
            sheet.gyro.resolution,
            own.rest_noise,
            tau_at_rest / rest.sum() + tau * (weights[free] ** 2).sum(),
        ),
        "instant": np.abs(slope) * unsure,
    }
    whole = np.sqrt(sum(part**2 for part in parts.values()))
    freedom = max(1.0, free.sum() / tau - 2.0)
    share = np.maximum(parts["noise after the exit"] / np.maximum(whole, 1e-15), 1e-2)
    return Rates(rate, parts, whole, scipy.stats.t.ppf(0.5 + 0.5 * COVERAGE, freedom / share**4))
