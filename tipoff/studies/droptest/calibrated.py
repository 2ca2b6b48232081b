"""From raw samples to rates in payload body axes: the inverse of what a gyro triad does to the rate
it feels.

    raw = (1 + diag s)(1 + E) w + b + G f + c (T - T0)          sensor axes
    w_body = R [(1 + diag s)(1 + E)]^-1 (raw - b - G f - c (T - T0))

s scale errors, E misalignments (rad), b biases, G sensitivity to the specific force f, c drift with
temperature, R mounting.
"""

from typing import NamedTuple

import numpy as np

from tipoff.studies.droptest.log import Log
from tipoff.studies.droptest.sheet import Sheet


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


def calibrated(sheet: Sheet, log: Log) -> Calibrated:
    """Rates and forces of a log, compensated and turned into body axes."""
    gyro, turn = sheet.gyro, sheet.mounting
    rate, force = log.rate - np.array(gyro.bias), None
    if log.acceleration is not None:
        assert sheet.accelerometer is not None  # as a sheet with accelerations has to have it
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


def missing_information(sheet: Sheet, log: Log) -> list[str]:
    """In words, what the sheet gives a coefficient for and the log has no column for."""
    notes = []
    if log.acceleration is None and np.any(sheet.gyro.g_sensitivity):
        notes.append("g-sensitivity not compensated: the log has no accelerations")
    if log.temperature is None and np.any(sheet.gyro.temperature):
        notes.append("drift with temperature not compensated: the log has no temperature")
    return notes
