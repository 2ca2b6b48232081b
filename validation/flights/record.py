"""A flight record reduced: bias, noise, thrust, speed and way, the end of the rail, rates and rattling.

An accelerometer at rest shows the force of its support, so the velocity along the rail is

    v = int (a - g sin(elevation)) dt

with the measured specific force a. The thrust less friction is m a. The bias of a rate is its mean before the
start, and its uncertainty is the noise over the square root of the samples. The noise at the exit is the
scatter about a straight line after it: the motor shakes the sensors more than the pad does.
"""

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff.faults import Fault, SceneError
from validation.flights.launchers import GRAVITY, HEDY, PSAS, Launcher

ROOT = "TIPOFF_MEASURED"
# columns x, y, z of a record that are x, y, z of the scene, with signs; right-handed
AXES = {PSAS.name: ((0, 1), (1, 1), (2, 1)), HEDY.name: ((1, -1), (0, 1), (2, 1))}
# s: pad, search of the start, search of the exit, scatter after the exit
PAD = {PSAS.name: (-0.6, -0.05), HEDY.name: (-0.76, -0.2)}
EXIT = {PSAS.name: (0.31, 0.33), HEDY.name: (0.50, 0.56)}
AFTER = {PSAS.name: 0.06, HEDY.name: 0.10}
SCALE = {PSAS.name: 0.01, HEDY.name: 0.02}  # relative error of the scale of an accelerometer


@dataclass(frozen=True)
class Record:
    """A record in axes of the scene, instants from the start. ``time`` (n,) s, ``force`` (n,3) specific force
    m/s2, ``rate`` (n,3) rad/s less the bias, ``bias`` and ``noise`` (3,) rad/s, ``speed`` m/s and ``way`` m
    (n,) along the rail, ``exit``: earliest and latest instant (s) at which the last guide leaves."""

    launcher: Launcher
    time: np.ndarray
    force: np.ndarray
    rate: np.ndarray
    bias: np.ndarray
    pad_noise: np.ndarray
    noise: np.ndarray
    speed: np.ndarray
    way: np.ndarray
    exit: tuple[float, float]

    def shaken(self, generator: np.random.Generator) -> np.ndarray:
        """Noise (n,3) rad/s of the spectrum that the rates have after the exit, with random phases."""
        end = self.exit[1] + AFTER[self.launcher.name]
        after = (self.time > self.exit[1]) & (self.time <= end)
        step, size = float(np.median(np.diff(self.time))), self.time.size
        frequency, found = np.fft.rfftfreq(size, step), []
        for one in self.rate[after].T:
            left = one - np.polyval(np.polyfit(self.time[after], one, 1), self.time[after])
            amplitude = np.abs(np.fft.rfft(left)) / np.sqrt(left.size)
            known = np.interp(frequency, np.fft.rfftfreq(left.size, step), amplitude)
            phase = np.exp(2j * np.pi * generator.random(frequency.size))
            found.append(np.fft.irfft(known * phase * np.sqrt(size), size))
        return np.column_stack(found)

    @property
    def left(self) -> float:
        """The middle of the interval of the exit (s)."""
        return 0.5 * (self.exit[0] + self.exit[1])

    def at_exit(self, values: np.ndarray) -> tuple[float, float]:
        """A quantity (n,) at the exit and half its change over the interval of the exit."""
        ends = np.interp(self.exit, self.time, values)
        return float(np.interp(self.left, self.time, values)), float(0.5 * abs(ends[1] - ends[0]))

    def exit_rate(self) -> tuple[np.ndarray, np.ndarray]:
        """Rates (3,) rad/s at the exit, by a straight line through ``AFTER`` from its middle, and their
        uncertainty: of the line, of the bias, and of the instant."""
        part = (self.time >= self.left) & (self.time <= self.left + AFTER[self.launcher.name])
        time = self.time[part] - self.left
        line, covariance = [], []
        for axis in range(3):
            found, spread = np.polyfit(time, self.rate[part, axis], 1, cov=True)
            moved = found[0] * 0.5 * (self.exit[1] - self.exit[0])
            line.append(found[1])
            covariance.append(spread[1, 1] + moved**2)
        return np.array(line), np.sqrt(covariance)


def read(folder: Path, launcher: Launcher) -> Record:
    """The reduced record of a launcher from the CSV file of its name in ``folder``. Raises SceneError."""
    path = folder / f"{launcher.name}.csv"
    if not path.is_file():
        raise SceneError([Fault(str(path), "record", "no file", "a record: time, forces, rates")])
    raw = np.genfromtxt(path, delimiter=",", skip_header=1)
    if raw.ndim != 2 or raw.shape[1] != 7 or not np.isfinite(raw).all():
        raise SceneError([Fault(str(path), "record", "a table", "seven columns of numbers")])
    return reduced(launcher, raw)


def reduced(launcher: Launcher, raw: np.ndarray) -> Record:
    """The record of the columns ``raw`` (n,7): s, m/s2, deg/s."""
    name, time = launcher.name, raw[:, 0]
    force, rate = (
        np.column_stack([sign * raw[:, first + place] for place, sign in AXES[name]])
        for first in (1, 4)
    )
    rate = np.radians(rate)
    pad = (time >= PAD[name][0]) & (time < PAD[name][1])
    bias, pad_noise = rate[pad].mean(axis=0), rate[pad].std(axis=0, ddof=1)
    # the first sample of the first lasting rise by a tenth of g over the pad
    risen = force[:, 0] - force[pad, 0].mean() > 0.1 * GRAVITY * max(1.0, force[pad, 0].std() * 6.0)
    lasting = np.flatnonzero(risen & np.roll(risen, -1) & np.roll(risen, -2) & ~pad)
    start = time[lasting[0]]
    time, left = time - start, tuple(float(end - start) for end in EXIT[name])
    along = force[:, 0] - GRAVITY * np.sin(launcher.elevation)
    along = np.where(time < 0.0, 0.0, along)
    steps = np.diff(time)
    speed = np.concatenate([[0.0], np.cumsum(0.5 * steps * (along[1:] + along[:-1]))])
    way = np.concatenate([[0.0], np.cumsum(0.5 * steps * (speed[1:] + speed[:-1]))])
    rate = rate - bias
    after = (time > left[1]) & (time <= left[1] + AFTER[name])
    noise = np.array(
        [
            np.std(one - np.polyval(np.polyfit(time[after], one, 1), time[after]), ddof=2)
            for one in rate[after].T
        ]
    )
    return Record(
        launcher, time, force, rate, bias, pad_noise, noise, speed, way, (left[0], left[1])
    )


def thrust(record: Record) -> np.ndarray:
    """Instants (s) and thrust less friction (N), (n,2): mean specific force in intervals of 10 ms, times the
    mass. Before the start the support carries the rocket."""
    edges = np.arange(0.0, record.launcher.until + 0.005, 0.010)
    rows = [(0.0, 0.0)]
    for low, high in itertools.pairwise(edges):
        part = (record.time >= low) & (record.time < high)
        if part.any():
            instant = float(record.time[part].mean())
            rows.append(
                (instant + (1e-3 if instant <= 0.0 else 0.0), float(record.force[part, 0].mean()))
            )
    values = np.array(rows)
    values[:, 1] *= record.launcher.mass
    return np.vstack([values, [record.launcher.until + 0.02, 0.0]])


def roll_axis(record: Record) -> list[float]:
    """Scatter of each rate after the exit over a straight line, deg/s: the bending of the body shakes the two
    lateral gyroscopes and not the one along the axis."""
    return np.degrees(record.noise).tolist()
