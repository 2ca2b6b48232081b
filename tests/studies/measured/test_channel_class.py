"""CFC filters against the gain of the double Butterworth pass, the corridor of the standard, and
scipy's own design."""

import numpy as np
import pytest
from scipy import signal

from tipoff.studies.measured.channel_class import DESIGN, coefficients, filtered, reach

CLASSES = (60, 180, 600, 1000)


def response(channel_class, frequency, rate):
    """Complex gain of the whole filter, from a long sine through its middle."""
    time = np.arange(int(40.0 * rate / channel_class)) / rate
    found = filtered(np.sin(2.0 * np.pi * frequency * time), channel_class, 1.0 / rate)
    middle = slice(time.size // 4, -time.size // 4)
    turning = np.column_stack(
        [np.sin(2.0 * np.pi * frequency * time), np.cos(2.0 * np.pi * frequency * time)]
    )[middle]
    (sine, cosine), *_ = np.linalg.lstsq(turning, found[middle], rcond=None)
    return complex(sine, cosine)


@pytest.mark.parametrize("channel_class", CLASSES)
def test_coefficients_are_those_of_scipy(channel_class):
    """Control: a design whose corner is the class, or the -3 dB of both passes, is another
    filter."""
    rate = 12.5 * channel_class
    top, bottom = coefficients(channel_class, rate)
    np.testing.assert_allclose(
        (top, bottom), signal.butter(2, DESIGN * channel_class, fs=rate), rtol=1e-12
    )
    assert top.sum() == pytest.approx(bottom.sum(), rel=1e-13)
    for wrong in (channel_class, 5.0 / 3.0 * channel_class):
        assert abs(signal.butter(2, wrong, fs=rate)[0][0] / top[0] - 1.0) > 0.2


@pytest.mark.parametrize("channel_class", CLASSES)
def test_gain_at_its_corners_and_no_phase(channel_class):
    """-6.02 dB at 2.0775 CFC exactly, -3.01 dB at 5/3 CFC but for the warping, which vanishes with
    the step."""
    rate = 200.0 * channel_class
    corner = response(channel_class, DESIGN * channel_class, rate)
    half_power = response(channel_class, 5.0 / 3.0 * channel_class, rate)
    assert abs(corner) == pytest.approx(0.5, abs=1e-9)
    assert abs(half_power) == pytest.approx(np.sqrt(0.5), rel=2e-4)
    assert max(abs(np.angle(corner)), abs(np.angle(half_power))) < 1e-9
    warped = np.tan(np.pi / 12.0 * 5.0 / 3.0) / np.tan(np.pi / 12.0 * DESIGN)
    coarse = response(channel_class, 5.0 / 3.0 * channel_class, 12.0 * channel_class)
    assert abs(coarse) == pytest.approx(1.0 / (1.0 + warped**4), rel=1e-6)


def test_one_pass_has_a_phase():
    """Control of the test above."""
    _, gain = signal.freqz(*coefficients(60, 12000.0), worN=[DESIGN * 60], fs=12000.0)
    assert np.degrees(np.angle(gain[0])) == pytest.approx(-90.0, abs=0.1)


def corridor(over):
    """Limits (dB) at a frequency over the class: +0.5/-0.5 dB at low ones, -1 at F_H = CFC, -4 at
    F_N = 5/3 CFC, then -9 and -24 dB per octave (SAE J211-1, data channel dynamic accuracy)."""
    octaves = np.log2(np.maximum(over / (5.0 / 3.0), 1.0))
    low = np.interp(
        np.log(over), np.log([0.1 / 60.0, 0.5, 1.0, 5.0 / 3.0]), [-0.5, -0.5, -1.0, -4.0]
    )
    return low - 24.0 * octaves, 0.5 - 9.0 * octaves


def decibels(over, rate_over_class):
    _, gain = signal.freqz(*coefficients(1.0, rate_over_class), worN=over, fs=rate_over_class)
    return 20.0 * np.log10(np.abs(gain) ** 2)


def test_gain_lies_in_the_corridor():
    """Control: the class itself as corner, a common mistake, leaves it. Sampled at its least rate
    the filter keeps the corridor up to F_N and the upper limit beyond; close to half that rate it
    falls below the lower one, as the bilinear transform has it."""
    over = np.geomspace(1e-3, 16.0, 400)
    low, high = corridor(over)
    found = decibels(over, 200.0)
    assert (found > low).all() and (found < high).all()
    _, gain = signal.freqz(*signal.butter(2, 1.0, fs=200.0), worN=over, fs=200.0)
    assert (20.0 * np.log10(np.abs(gain) ** 2) < low).any()
    coarse = over[over < 4.9]
    low, high = corridor(coarse)
    found = decibels(coarse, 10.0)
    assert (
        (found < high).all()
        and (found > low)[coarse <= 5.0 / 3.0].all()
        and not (found > low).all()
    )


def test_a_straight_line_stays_and_a_jump_ends_within_reach():
    time = np.arange(2000) * 1e-3
    line = 3.0 - 2.0 * time
    np.testing.assert_allclose(filtered(line, 60, 1e-3), line, atol=1e-10)
    jump = filtered((time >= 1.0).astype(float), 60, 1e-3)
    away = np.abs(time - 1.0) > reach(60)
    assert (
        np.abs(jump - (time >= 1.0))[away].max() < 1e-4 < np.abs(jump - (time >= 1.0))[~away].max()
    )
    assert jump[999:1001].sum() == pytest.approx(1.0, abs=1e-6)  # symmetric about the jump
