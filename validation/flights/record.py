"""The two records, read and reduced as a launch of ``tipoff measured``.

Each has what was read from it by eye: the time at rest, the interval of the exit, and the time after it that is
free of the rail.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.studies.measured.launch import record as launch
from tipoff.studies.measured.launch.record import Record
from tipoff.studies.measured.log import Calibrated
from validation.flights.launchers import GRAVITY, HEDY, PSAS, Launcher

ROOT = "TIPOFF_MEASURED"
# columns x, y, z of a record that are x, y, z of the scene, with signs; right-handed
AXES = {PSAS.name: ((0, 1), (1, 1), (2, 1)), HEDY.name: ((1, -1), (0, 1), (2, 1))}
# s: rest, exit, scatter after the exit
REST = {PSAS.name: (-0.6, -0.05), HEDY.name: (-0.76, -0.2)}
EXIT = {PSAS.name: (0.31, 0.33), HEDY.name: (0.50, 0.56)}
AFTER = {PSAS.name: 0.06, HEDY.name: 0.10}
SCALE = {PSAS.name: 0.01, HEDY.name: 0.02}  # relative error of the scale of an accelerometer


@dataclass(frozen=True)
class Flown(Record):
    """The record of a ``launcher``."""

    launcher: Launcher


def read(folder: Path, launcher: Launcher) -> Flown:
    """The reduced record of a launcher from the CSV file of its name in ``folder``. Raises SceneError."""
    path = folder / f"{launcher.name}.csv"
    if not path.is_file():
        raise SceneError([Fault(str(path), "record", "no file", "a record: time, forces, rates")])
    raw = np.genfromtxt(path, delimiter=",", skip_header=1)
    if raw.ndim != 2 or raw.shape[1] != 7 or not np.isfinite(raw).all():
        raise SceneError([Fault(str(path), "record", "a table", "seven columns of numbers")])
    return reduced(launcher, raw)


def reduced(launcher: Launcher, raw: np.ndarray) -> Flown:
    """The record of the columns ``raw`` (n,7): s, m/s2, deg/s."""
    name, time = launcher.name, raw[:, 0]
    force, rate = (
        np.column_stack([sign * raw[:, first + place] for place, sign in AXES[name]])
        for first in (1, 4)
    )
    samples = Calibrated(time, np.radians(rate), force, None)
    rest = (time >= REST[name][0]) & (time < REST[name][1])
    first = launch.first_rise(force[:, 0], rest)
    assert first is not None  # both records have a start
    start = float(time[first])
    early, late = (end - start for end in EXIT[name])
    gravity = float(GRAVITY * np.sin(launcher.elevation))
    found = launch.reduced(samples, rest, start, gravity, (early, late), AFTER[name])
    return Flown(**vars(found), launcher=launcher)


def thrust(own: Flown) -> np.ndarray:
    """Instants (s) and thrust less friction (N), (n,2)."""
    return launch.thrust(own, own.launcher.mass, own.launcher.until)
