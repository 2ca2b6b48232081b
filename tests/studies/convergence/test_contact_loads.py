"""Impulse and filtered peak of pad forces that have closed forms."""

import math

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.studies.convergence import contact_loads

SCENE = scenes.load("reference")  # samples every 0.05 ms, as flight's


def pressed(force, face=2, axis=1):
    """A run with ``force(t)`` (n,) N on one face; faces 2 and 3 are those of the second pad."""
    run = flight()
    run.pad_force[:, face, axis] = force(run.time)
    return run


def test_impulse_of_a_half_sine():
    """2 F T / pi; the trapezoidal rule over m intervals is short of it by (pi/m)^2 / 12."""
    duration = 4e-3
    run = pressed(lambda t: 50.0 * np.sin(np.pi * t / duration) * (t < duration))
    found = contact_loads.impulses(SCENE, run)
    assert found[1] == pytest.approx(
        2.0 * 50.0 * duration / math.pi, rel=2.0 * (math.pi / 80) ** 2 / 12
    )
    assert np.flatnonzero(found).tolist() == [1]


def test_faces_of_one_pad_add_up_as_vectors():
    run = pressed(lambda t: 3.0 + 0.0 * t)
    run.pad_force[:, 3, 2] = 4.0
    assert contact_loads.impulses(SCENE, run)[1] == pytest.approx(5.0 * run.time[-1])
    assert contact_loads.filtered_peak(SCENE, run) == pytest.approx(5.0)


@pytest.mark.parametrize("frequency, kept", [(20.0, 1.0), (1000.0, 0.5), (9000.0, 0.0)])
def test_filter_halves_the_amplitude_at_its_cut_off_and_shifts_nothing(frequency, kept):
    """100 N with a ripple of 10 N; looked at where the ends of the record, which ring, are far."""

    def ripple(t):
        return (
            10.0
            * np.cos(2.0 * np.pi * frequency * (t - 0.015))
            * np.exp(-(((t - 0.015) / 4e-3) ** 2))
        )

    run = pressed(lambda t: 100.0 + ripple(t))
    assert contact_loads.cutoff(SCENE) == 1000.0
    assert contact_loads.filtered_peak(SCENE, run) == pytest.approx(100.0 + 10.0 * kept, abs=0.3)


def test_cut_off_stays_below_what_the_samples_hold():
    coarse = SCENE.replace({"output.interval": "0.5 ms"})
    assert contact_loads.cutoff(coarse) == pytest.approx(400.0)
