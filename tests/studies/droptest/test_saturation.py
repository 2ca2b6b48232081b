"""Saturation is a run of equal extreme samples, at any level; a quiet sensor repeats its extremes
too, and is not saturated."""

import numpy as np
import pytest

from tipoff.studies.droptest.saturation import saturated

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
