"""Saturation is a run of equal extreme samples, at any level; a quiet sensor repeats its extremes
too, and is not saturated."""

import numpy as np
import pytest

from tipoff.studies.measured.saturation import saturated

RANGE, STEP = 250.0, 0.0076


def channel(noise=0.2, plateau=320.0, count=4000):
    """A channel (n,1) at rest, then at ``plateau`` with noise, rounded to the step."""
    rate = np.where(np.arange(count) < count // 2, 0.0, plateau)
    rate = rate + np.random.default_rng(1).normal(0.0, noise, count)
    return STEP * np.round(rate / STEP)[:, None]


@pytest.mark.parametrize("level", [250.0, 249.99998, 249.5, 250.35, 243.0, 200.0, 125.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_clipping_is_found_at_any_level(level, sign):
    values = sign * np.minimum(channel(), level)
    found = saturated(values, RANGE, STEP)[:, 0]
    np.testing.assert_array_equal(found, np.abs(values[:, 0]) == level)
    # Control: equality with the range finds the first and fourth alone.
    assert (np.abs(values) >= RANGE * (1.0 - 1e-9)).any() == (level >= 250.0)


def test_both_signs_have_their_own_level():
    values = np.clip(np.concatenate([channel(), -channel()]), -241.0, 249.0)
    found = saturated(values, RANGE, STEP)[:, 0]
    assert found[values[:, 0] == 249.0].all() and found[values[:, 0] == -241.0].all()
    assert found.sum() < 4100


def test_a_low_pass_after_the_clipping_is_seen():
    values = np.minimum(channel(), 250.0)
    smooth = np.convolve(values[:, 0], np.ones(3) / 3.0, "same")[:, None]
    smooth[2100::7] -= 0.05
    assert saturated(smooth, RANGE, STEP)[2010:3990].all()


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.004, 0.0076, 0.02, 0.2])
@pytest.mark.parametrize("plateau", [0.0, 5.0, 120.0])
def test_a_sensor_within_its_range_is_not_saturated(noise, plateau):
    """Control: rest and a settled rate, down to noise far below one step."""
    assert not saturated(channel(noise, plateau), RANGE, STEP).any()


@pytest.mark.parametrize("level", [250.0, 249.5, 243.0, 230.0])
@pytest.mark.parametrize("lsb", [1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_noise_of_a_step_or_two_on_the_clipped_level(level, lsb, sign):
    """Added after the clipping. Controls: the longest run of equal samples does not tell it, and a
    settled rate there, with the noise of the sensor, is none."""
    values = np.minimum(channel(), level)
    clipped = values == level
    added = np.random.default_rng(2).integers(-lsb, lsb + 1, values.shape) * STEP
    found = saturated(sign * (values + clipped * added), RANGE, STEP)
    np.testing.assert_array_equal(found, clipped)
    if level < RANGE * (1.0 - 5e-3):
        assert not saturated(sign * channel(plateau=level), RANGE, STEP).any()


@pytest.mark.parametrize("level, count", [(249.9, 3), (246.0, 3), (240.0, 5), (150.0, 5)])
def test_a_short_clip(level, count):
    """Control: two samples at 150 deg/s may be equal by chance."""
    values = channel(plateau=100.0)
    values[3000 : 3000 + count] = level
    assert np.flatnonzero(saturated(values, RANGE, STEP)).tolist() == list(
        range(3000, 3000 + count)
    )
    values[3000 : 3000 + count] = 100.0
    values[3000:3002] = 150.0
    assert not saturated(values, RANGE, STEP).any()


@pytest.mark.parametrize("level", [249.0, 240.0, 200.0, 150.0])
def test_a_vibration_that_is_clipped_in_each_cycle(level):
    """One or two samples of nine in a row, both signs. Control: the same vibration, smaller."""
    place = np.arange(4000)
    ringing = 320.0 * np.sin(2.0 * np.pi * place / 9.3) * np.exp(-(place - 1000) / 300.0)
    rate = np.where((place > 1000) & (place < 1400), ringing, 0.0)
    rate += np.random.default_rng(4).normal(0.0, 0.2, 4000)
    rate = STEP * np.round(rate / STEP)[:, None]
    clipped = np.clip(rate, -level, level)
    np.testing.assert_array_equal(saturated(clipped, RANGE, STEP), np.abs(clipped) == level)
    assert not saturated(0.7 * rate, RANGE, STEP).any()


@pytest.mark.parametrize("amplitude", [10.0, 100.0, 240.0, 246.0, 249.0])
@pytest.mark.parametrize("period", [500, 5000, 50_000])
@pytest.mark.parametrize("noise", [0.0, 0.002, 0.01, 0.1])
def test_a_smooth_maximum_is_no_saturation(amplitude, period, noise):
    """A slow oscillation repeats its largest value too, up to 40 times in a row without noise."""
    place = np.arange(8000)
    rate = amplitude * np.sin(2.0 * np.pi * place / period)
    rate += np.random.default_rng(4).normal(0.0, noise, place.size)
    assert not saturated(STEP * np.round(rate / STEP)[:, None], RANGE, STEP).any()


def test_the_step_is_found_where_none_is_stated():
    """Accelerations have no stated resolution. Control: the same without a clip."""
    values = channel(plateau=100.0)
    values[3000:3010] = 240.0 + STEP * np.array([0, 1, 0, -1, 0, 1, 1, 0, -1, 0])[:, None]
    assert np.flatnonzero(saturated(values, RANGE)).tolist() == list(range(3000, 3010))
    assert not saturated(channel(plateau=100.0), RANGE).any()
