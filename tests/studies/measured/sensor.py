"""A model of an inertial unit, for logs that are simulated and for tests of what reads them.

    gyro    raw = Q[(1 + diag s)(1 + E) R'w + b + G R'f + c (T - T0) + white + flicker]
            (see studies.measured.calibrated)
    force   raw = Q[(1 + diag s_a) R'f + b_a + white]

White noise of density N (rad/s/sqrt(Hz), the angle random walk of IEEE 952) has the standard
deviation N / sqrt(interval) a sample; flicker has the two-sided density B^2 / (2 pi f) of bias
instability B. Q rounds to the resolution and clips at the range. Samples are taken at points in
time: the model has no anti-alias filter.
"""

from typing import NamedTuple

import numpy as np

from tipoff.studies.measured.log import sensitivity

# times the record: flicker is drawn with frequencies below the lowest that the record resolves
_LONGER = 4


class Channel(NamedTuple):
    """Three gyros or accelerometers, SI: bias (3,), scale_error (3,), density of white noise,
    resolution, range."""

    bias: np.ndarray
    scale_error: np.ndarray
    density: float
    resolution: float
    range: float


class Sensor(NamedTuple):
    """gyro and force channels; misalignment (3,3) rad, g_sensitivity (3,3) rad s/m, drift (3,)
    rad/s/K from reference_temperature (K), bias instability (rad/s), mounting (3,3) from sensor to
    body axes."""

    gyro: Channel
    force: Channel
    misalignment: np.ndarray
    g_sensitivity: np.ndarray
    drift: np.ndarray
    reference_temperature: float
    instability: float
    mounting: np.ndarray


def exact(
    sensor: Sensor, rate: np.ndarray, force: np.ndarray, temperature: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Raw rates and forces (n,3) of the body's rate (n,3) rad/s and specific force (n,3) m/s2,
    without noise, rounding or range."""
    felt, pushed = rate @ sensor.mounting, force @ sensor.mounting
    raw = (
        felt @ sensitivity(sensor.gyro.scale_error, sensor.misalignment).T
        + sensor.gyro.bias
        + pushed @ sensor.g_sensitivity.T
    )
    raw = raw + (temperature - sensor.reference_temperature)[:, None] * sensor.drift
    return raw, pushed * (1.0 + sensor.force.scale_error) + sensor.force.bias


def measured(
    sensor: Sensor, rate, force, temperature, interval: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """The same as the sensor gives it, sampled every ``interval`` (s)."""
    raw, pushed = exact(sensor, rate, force, temperature)
    raw = raw + flicker(raw.shape, interval, sensor.instability, rng)
    return _given(sensor.gyro, raw, interval, rng), _given(sensor.force, pushed, interval, rng)


def _given(
    channel: Channel, raw: np.ndarray, interval: float, rng: np.random.Generator
) -> np.ndarray:
    noisy = raw + channel.density / np.sqrt(interval) * rng.standard_normal(raw.shape)
    rounded = (
        channel.resolution * np.round(noisy / channel.resolution) if channel.resolution else noisy
    )
    return np.clip(rounded, -channel.range, channel.range)


def flicker(
    shape: tuple[int, int], interval: float, instability: float, rng: np.random.Generator
) -> np.ndarray:
    """Noise (n,k) of the density of bias instability (rad/s), made of its frequencies above
    zero."""
    length = _LONGER * shape[0]
    frequency = np.fft.rfftfreq(length, interval)[1:]
    size = np.sqrt(0.5 * instability**2 / (2.0 * np.pi * frequency) * length / interval)
    draws = rng.standard_normal((2, frequency.size, shape[1]))
    spectrum = np.concatenate([np.zeros((1, shape[1])), size[:, None] * (draws[0] + 1j * draws[1])])
    return np.fft.irfft(spectrum, length, axis=0)[: shape[0]]
