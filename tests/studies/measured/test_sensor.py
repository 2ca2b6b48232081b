"""The calibration undoes the model of the sensor, and the noise of the model has the laws it
states."""

import numpy as np
import pytest
from scipy.signal import lfilter

from tests.studies.measured.sensor import Channel, Sensor, exact, flicker, measured
from tests.studies.measured.synthetic import INTERVAL, QUIET, log, motion, sheet
from tipoff.studies.measured.log import calibrated, sensitivity
from tipoff.studies.measured.reduction import correlation_time, instability_variance

SKEW, SENSITIVE = (
    np.array([[0.0, 2e-3, -1e-3], [3e-3, 0.0, 1e-3], [-2e-3, 4e-3, 0.0]]),
    1e-4 * np.arange(9.0).reshape(3, 3),
)
AXES = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
UNIT = Sensor(
    Channel(np.array([0.01, -0.02, 0.03]), np.array([0.02, -0.01, 0.005]), 0.0, 0.0, 10.0),
    Channel(np.array([0.1, -0.2, 0.3]), np.array([0.01, 0.02, -0.01]), 0.0, 0.0, 1000.0),
    SKEW,
    SENSITIVE,
    np.array([1e-3, -2e-3, 3e-3]),
    298.15,
    0.0,
    AXES,
)
KNOWN = {
    "axes": AXES.tolist(),
    "gyro": {
        "bias": UNIT.gyro.bias.tolist(),
        "scale_error": UNIT.gyro.scale_error.tolist(),
        "misalignment": SKEW.tolist(),
        "g_sensitivity": SENSITIVE.tolist(),
        "temperature": UNIT.drift.tolist(),
        "reference_temperature": 298.15,
    },
    "accelerometer": {
        "range": 1000.0,
        "bias": UNIT.force.bias.tolist(),
        "scale_error": UNIT.force.scale_error.tolist(),
    },
}


def test_calibration_is_the_inverse_of_the_sensor():
    """Control: without any one of its terms it is not."""
    before, after = [0.01, -0.02, 0.03], [0.2, -0.1, 0.05]
    raw = log(UNIT, before, after, np.random.default_rng(1), kelvin=303.15)
    _, rate, force = motion(before, after)
    found = calibrated(sheet(**KNOWN), raw)
    np.testing.assert_allclose(found.rate, rate, atol=1e-15)
    np.testing.assert_allclose(found.force, force, atol=1e-12)
    for term in ("bias", "scale_error", "misalignment", "g_sensitivity", "temperature"):
        less = KNOWN | {
            "gyro": {name: value for name, value in KNOWN["gyro"].items() if name != term}
        }
        assert np.abs(calibrated(sheet(**less), raw).rate - rate).max() > 1e-4
    assert (
        np.abs(calibrated(sheet(**KNOWN | {"axes": np.eye(3).tolist()}), raw).rate - rate).max()
        > 0.1
    )


def test_sensor_written_out_by_hand():
    """One component of raw = (1 + s)(w + E w) + b + G f + c dT, all in sensor axes (x' = -y, y' =
    x, z' = z of the body)."""
    rate, force = np.array([[0.1, 0.2, 0.3]]), np.array([[1.0, 2.0, 3.0]])
    raw, pushed = exact(UNIT, rate, force, np.array([300.15]))
    expected = (
        1.02 * (-0.2 + 2e-3 * 0.1 - 1e-3 * 0.3)
        + 0.01
        + 1e-4 * (0.0 * -2.0 + 1.0 * 1.0 + 2.0 * 3.0)
        + 2.0 * 1e-3
    )
    assert raw[0, 0] == pytest.approx(expected, rel=1e-14)
    assert pushed[0].tolist() == pytest.approx(
        [1.01 * -2.0 + 0.1, 1.02 * 1.0 - 0.2, 0.99 * 3.0 + 0.3], rel=1e-14
    )
    np.testing.assert_allclose(sensitivity([0.0] * 3, np.zeros((3, 3))), np.eye(3))


def test_white_noise_rounding_and_range():
    channel = Channel(np.zeros(3), np.zeros(3), 1e-4, 5e-4, 0.01)
    still = np.zeros((20000, 3))
    still[:100] = 1.0
    raw, _ = measured(
        QUIET._replace(gyro=channel),
        still,
        still,
        np.full(20000, 293.15),
        INTERVAL,
        np.random.default_rng(2),
    )
    assert (raw[:100] == 0.01).all()
    assert np.abs(raw[100:] / 5e-4 - np.round(raw[100:] / 5e-4)).max() < 1e-9
    expected = np.hypot(1e-4 / np.sqrt(INTERVAL), 5e-4 / np.sqrt(12.0))
    assert raw[100:].std() == pytest.approx(expected, rel=4.0 / np.sqrt(2.0 * 59700))


def test_flicker_has_the_allan_deviation_of_bias_instability():
    """sqrt(2 ln 2 / pi) B = 0.664 B at every averaging time far from both ends of the record (IEEE
    952)."""
    values = flicker((2**14, 48), 1.0, 1.0, np.random.default_rng(3))
    for block in (64, 256):
        means = values.reshape(-1, block, 48).mean(axis=1)
        allan = np.sqrt(0.5 * np.mean(np.diff(means, axis=0) ** 2))
        assert allan == pytest.approx(np.sqrt(2.0 * np.log(2.0) / np.pi), rel=0.03)


def test_instability_of_a_difference_is_what_flicker_gives_it():
    weights = np.zeros(600)
    weights[50:350], weights[450:550] = -1.0 / 300.0, 1.0 / 100.0
    found = (weights @ flicker((600, 1500), INTERVAL, 0.01, np.random.default_rng(4))).std()
    assert found == pytest.approx(
        np.sqrt(instability_variance(weights, INTERVAL, 0.01)), rel=4.0 / np.sqrt(2.0 * 1500)
    )


def test_correlation_time_of_white_and_of_coloured_noise():
    """First-order noise of coefficient a has tau = (1 + a)/(1 - a). Control: taken as white its
    mean is far too sure."""
    rng = np.random.default_rng(5)
    white = rng.standard_normal((4000, 3))
    errors = 4.0 * 2.0 * np.sqrt(5.0 / white.size)  # four standard errors of five lags
    assert correlation_time([white]) == pytest.approx(1.0, abs=errors)
    coloured = lfilter([1.0], [1.0, -0.8], white, axis=0)
    assert correlation_time([coloured[100:2000], coloured[2000:]]) == pytest.approx(9.0, rel=0.25)
