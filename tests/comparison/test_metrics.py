"""Metrics with known answers."""

import math

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff.comparison import iso18571, metrics

TIME = np.linspace(0.0, 1.0, 1001)
WAVE = np.sin(2.0 * np.pi * 3.0 * TIME) * np.exp(-TIME)


def ramps(*final):
    """Rates that grow linearly to ``final`` (rad/s)."""
    return lambda t: np.outer(t / t[-1], final)


def test_identical_curves_are_perfect():
    assert iso18571.rate(WAVE, WAVE) == (1.0, 1.0, 1.0, 1.0, 1.0)
    same = metrics.compare(flight(ramps(0.1, 0.2, 0.3)), flight(ramps(0.1, 0.2, 0.3)))
    assert (
        same.rate_relative_l2 == same.velocity_relative_l2 == same.settled_rate_error_deg_s == 0.0
    )
    assert same.iso18571 == 1.0
    assert same.sprague_geers_magnitude == 0.0
    assert same.sprague_geers_phase == pytest.approx(0.0, abs=1e-7)


def test_relative_l2_of_a_scaled_curve_is_the_scale_error():
    difference = metrics.compare(flight(ramps(0.1, 0.2, 0.3)), flight(ramps(0.103, 0.206, 0.309)))
    assert difference.rate_relative_l2 == pytest.approx(0.03, rel=1e-12)
    assert difference.sprague_geers_magnitude == pytest.approx(0.03, rel=1e-12)
    assert difference.settled_rate_error_deg_s == pytest.approx(math.degrees(0.009), rel=0.04)


def test_relative_l2_sums_over_axes():
    """An axis that hardly moves cannot dominate: 100 % wrong on 1 % of the amplitude is 1 %."""
    difference = metrics.compare(flight(ramps(1.0, 0.0, 0.01)), flight(ramps(1.0, 0.0, 0.02)))
    assert difference.rate_relative_l2 == pytest.approx(0.01, rel=1e-3)


def test_settled_error_is_the_worst_axis_with_its_sign_beside_it():
    errors = metrics.compare(flight(ramps(0.1, 0.0, 0.0)), flight(ramps(0.1, -0.02, 0.01)))
    x, y, z = errors.settled_rate_error_xyz_deg_s
    assert x == pytest.approx(0.0, abs=1e-12) and y < 0.0 < z
    assert errors.settled_rate_error_deg_s == -y


def test_sprague_geers_of_a_scaled_curve():
    magnitude, phase = metrics.sprague_geers(TIME, WAVE[:, None], 1.25 * WAVE[:, None])
    assert magnitude == pytest.approx(0.25, rel=1e-12)
    assert phase == pytest.approx(0.0, abs=1e-7)


def test_sprague_geers_of_a_shifted_sine_is_shift_over_pi():
    shift = 0.3
    whole_periods = 2.0 * np.pi * 5.0 * TIME
    magnitude, phase = metrics.sprague_geers(
        TIME, np.sin(whole_periods)[:, None], np.sin(whole_periods - shift)[:, None]
    )
    assert magnitude == pytest.approx(0.0, abs=1e-9)
    assert phase == pytest.approx(shift / math.pi, rel=1e-9)


def test_zero_reference_has_no_relative_error():
    difference = metrics.compare(flight(), flight(ramps(0.1, 0.0, 0.0)))
    assert difference.rate_relative_l2 is None
    assert difference.sprague_geers_magnitude is None
    assert difference.settled_rate_error_deg_s > 0.0


def test_unsettled_run_has_no_settled_error():
    difference = metrics.compare(
        flight(ramps(0.1, 0.0, 0.0)), flight(ramps(0.1, 0.0, 0.0), status="jammed")
    )
    assert difference.settled_rate_error_deg_s is None
    assert difference.rate_relative_l2 == 0.0


def test_iso_phase_of_a_shifted_pulse():
    """A shift of 2 % of the length costs 0.02 / 0.2 of the phase score and nothing of magnitude and
    slope."""
    reference = np.exp(-0.5 * ((TIME - 0.5) / 0.05) ** 2)
    late = np.exp(-0.5 * ((TIME - 0.52) / 0.05) ** 2)
    rating = iso18571.rate(reference, late)
    assert iso18571.best_shift(reference, late) == 20
    assert iso18571.best_shift(late, reference) == -20
    assert rating.phase == pytest.approx(1.0 - 20 / (0.2 * 1001), rel=1e-12)
    assert rating.magnitude == pytest.approx(1.0, abs=1e-6)
    assert rating.slope == pytest.approx(1.0, abs=1e-6)


def test_iso_corridor_of_a_constant_offset():
    """25 % off: ((0.5 - 0.25) / (0.5 - 0.05))^2."""
    reference = np.ones(200)
    assert iso18571.rate(reference, reference + 0.25).corridor == pytest.approx(
        (0.25 / 0.45) ** 2, rel=1e-12
    )
    assert iso18571.rate(reference, reference + 0.04).corridor == 1.0
    assert iso18571.rate(reference, reference + 0.6).corridor == 0.0


def test_iso_magnitude_and_slope_of_a_scaled_line():
    """Warping cannot help a constant; slopes of a line differ by the scale error everywhere."""
    assert iso18571.rate(np.ones(200), np.full(200, 1.1)).magnitude == pytest.approx(
        1.0 - 0.1 / 0.5, rel=1e-9
    )
    line = np.linspace(1.0, 2.0, 200)
    assert iso18571.rate(line, 1.5 * line).slope == pytest.approx(1.0 - 0.5 / 2.0, rel=1e-9)


def test_iso_weights_and_a_hopeless_curve():
    rating = iso18571.rate(WAVE, 0.8 * WAVE)
    parts = 0.4 * rating.corridor + 0.2 * (rating.phase + rating.magnitude + rating.slope)
    assert rating.overall == pytest.approx(parts, rel=1e-12)
    assert iso18571.rate(WAVE, -5.0 * WAVE).overall < 0.25


def test_iso_refuses_curves_of_different_length():
    with pytest.raises(ValueError, match="one length"):
        iso18571.rate(WAVE, WAVE[:-1])
