"""A log of a launch reduced: bias, start, speed and way, the end of the rail, rates and thrust.

An accelerometer at rest shows the force of its support, so the velocity along the rail is

    v = int (a - g_x) dt

with the measured specific force a along the rail and the component g_x that it shows at rest. The thrust less
friction is m a. The bias of a rate is its mean before the start. The noise at the exit is the scatter about a
straight line after it: the motor shakes the sensors more than the pad does.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from tipoff.studies.measured.events import GRAVITY
from tipoff.studies.measured.log import Calibrated

_RISE = 0.1  # of g: rise of the specific force that is a start
_SIGMAS = 6.0  # of the noise at rest in m/s2, by which a larger rise is needed


@dataclass(frozen=True)
class Record:
    """A launch in body axes, instants from the start. ``time`` (n,) s, ``force`` (n,3) specific force m/s2,
    ``rate`` (n,3) rad/s less the ``bias`` (3,), ``rest_noise`` and ``noise`` (3,) rad/s of a sample at rest and
    after the exit, ``speed`` m/s and ``way`` m (n,) along the rail, ``exit``: earliest and latest instant (s) at
    which the last guide leaves, ``after``: time after the exit (s) whose rates are extrapolated to it."""

    time: np.ndarray
    force: np.ndarray
    rate: np.ndarray
    bias: np.ndarray
    rest_noise: np.ndarray
    noise: np.ndarray
    speed: np.ndarray
    way: np.ndarray
    exit: tuple[float, float]
    after: float

    @property
    def interval(self) -> float:
        """Between samples (s)."""
        return float(np.median(np.diff(self.time)))

    @property
    def left(self) -> float:
        """The middle of the interval of the exit (s)."""
        return 0.5 * (self.exit[0] + self.exit[1])

    @property
    def half(self) -> float:
        """Half the interval of the exit (s)."""
        return 0.5 * (self.exit[1] - self.exit[0])

    def at_exit(self, values: np.ndarray) -> tuple[float, float]:
        """A quantity (n,) at the exit and half its change over the interval of the exit."""
        ends = np.interp(self.exit, self.time, values)
        return float(np.interp(self.left, self.time, values)), float(0.5 * abs(ends[1] - ends[0]))

    def free(self, begin: float) -> np.ndarray:
        """Whether a sample (n,) is from ``begin`` (s) on and no more than ``after`` behind the exit."""
        return (self.time >= begin) & (self.time <= self.left + self.after)

    def line(self, begin: float | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rates (3,) rad/s at the exit by a straight line through the samples of ``free``, from the exit on
        where ``begin`` is None; their standard uncertainty by white noise, and the slope (3,) rad/s2."""
        part = self.free(self.left if begin is None else begin)
        time, found = self.time[part] - self.left, []
        for axis in range(3):
            line, spread = np.polyfit(time, self.rate[part, axis], 1, cov=True)
            found.append((line[1], spread[1, 1], line[0]))
        rate, variance, slope = np.array(found).T
        return rate, np.sqrt(variance), slope

    def shaken(self, generator: np.random.Generator) -> np.ndarray:
        """Noise (n,3) rad/s of the spectrum that the rates have after the exit, with random phases."""
        after = (self.time > self.exit[1]) & (self.time <= self.exit[1] + self.after)
        step, size = self.interval, self.time.size
        frequency, found = np.fft.rfftfreq(size, step), []
        for left in scatter(self.time[after], self.rate[after]).T:
            amplitude = np.abs(np.fft.rfft(left)) / np.sqrt(left.size)
            known = np.interp(frequency, np.fft.rfftfreq(left.size, step), amplitude)
            phase = np.exp(2j * np.pi * generator.random(frequency.size))
            found.append(np.fft.irfft(known * phase * np.sqrt(size), size))
        return np.column_stack(found)


def scatter(time: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Residuals (n,3) of ``rate`` (n,3) about straight lines over ``time`` (n,)."""
    lines = [np.polyval(np.polyfit(time, one, 1), time) for one in rate.T]
    return rate - np.column_stack(lines)


def first_rise(along: np.ndarray, rest: np.ndarray, lasting: int = 3) -> int | None:
    """The first sample of the first rise of the specific force ``along`` the rail (n,) by a tenth of g over that
    at ``rest``, a mask (n,), which is no part of the search. It must last for ``lasting`` samples. None without
    one."""
    risen = along - along[rest].mean() > threshold(along[rest])
    both = np.all([np.roll(risen, -later) for later in range(lasting)], axis=0)
    found = np.flatnonzero(both & ~rest)
    return int(found[0]) if found.size else None


def threshold(rest: np.ndarray) -> float:
    """The rise (m/s2) that is a start, from the specific force at ``rest`` (k,)."""
    return _RISE * GRAVITY * max(1.0, float(rest.std()) * _SIGMAS)


def travelled(time: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Speed (n,) m/s and way (n,) m from the acceleration ``along`` the rail (n,) m/s2, at rest before zero."""
    along = np.where(time < 0.0, 0.0, along)
    steps = np.diff(time)
    speed = np.concatenate([[0.0], np.cumsum(0.5 * steps * (along[1:] + along[:-1]))])
    way = np.concatenate([[0.0], np.cumsum(0.5 * steps * (speed[1:] + speed[:-1]))])
    return speed, way


def reduced(
    samples: Calibrated,
    rest: np.ndarray,
    start: float,
    gravity: float,
    exit: tuple[float, float],
    after: float,
) -> Record:
    """The record of calibrated ``samples`` that are at ``rest`` in a mask (n,) and begin to move at ``start`` (s
    of the log); ``gravity``: specific force at rest along the rail (m/s2); ``exit`` and ``after`` (s) as in
    ``Record``."""
    assert samples.force is not None  # every launch has accelerations
    time = samples.time - start
    bias, rest_noise = samples.rate[rest].mean(axis=0), samples.rate[rest].std(axis=0, ddof=1)
    speed, way = travelled(time, samples.force[:, 0] - gravity)
    rate = samples.rate - bias
    free = (time > exit[1]) & (time <= exit[1] + after)
    return Record(
        time=time,
        force=samples.force,
        rate=rate,
        bias=bias,
        rest_noise=rest_noise,
        noise=np.std(scatter(time[free], rate[free]), axis=0, ddof=2),
        speed=speed,
        way=way,
        exit=exit,
        after=after,
    )


def thrust(record: Record, mass: float, until: float, width: float = 0.010) -> np.ndarray:
    """Instants (s) and thrust less friction (N), (n,2), ``until`` an instant (s): mean specific force in
    intervals of ``width`` (s), times the ``mass`` (kg). Before the start the support carries the rocket."""
    edges = np.arange(0.0, until + 0.5 * width, width)
    rows = [(0.0, 0.0)]
    for low, high in itertools.pairwise(edges):
        part = (record.time >= low) & (record.time < high)
        if part.any():
            instant = float(record.time[part].mean())
            first = 1e-3 if instant <= 0.0 else 0.0
            rows.append((instant + first, float(record.force[part, 0].mean())))
    values = np.array(rows)
    values[:, 1] *= mass
    return np.vstack([values, [until + 2.0 * width, 0.0]])
