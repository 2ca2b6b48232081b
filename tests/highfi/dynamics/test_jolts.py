"""Vibration that resting leaves out, against oscillators of known response."""

import numpy as np
import pytest

from tipoff.highfi.dynamics import jolts
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.statics.inertial import TERMS

FREQUENCY, SIZE, AMOUNT = 1e4, 7e-11, 50.0  # rad/s, m per m/s2, m/s2
PERIOD = 2.0 * np.pi / FREQUENCY


def rails() -> Rails:
    """One rail that moves by ``SIZE`` under its first term."""
    size = np.zeros((1, TERMS))
    size[0, 0] = SIZE
    return Rails(
        blocks=[np.arange(1)],
        groups=np.zeros((1, 1), dtype=bool),
        deflections=[[]],
        size=size,
        frequency=np.full((1, 1), FREQUENCY),
        at_ignition=True,
        stride=1,
        jumps=np.zeros(0),
    )


def left_out(accelerations: np.ndarray, span: float) -> float:
    """After means of the first term over intervals of ``span`` (s)."""
    one, found = rails(), 0.0
    modes = jolts.begin(one).modes
    for acceleration in accelerations:
        amounts = np.zeros(TERMS)
        amounts[0] = acceleration
        found = jolts.follow(one, modes, amounts, span)
    return found


def test_a_sudden_acceleration_leaves_out_its_static_deflection():
    """An undamped oscillator under a sudden load swings by its static deflection for ever;
    several modes are allowed ``MODES`` times as much."""
    for count in (1, 7, 100):
        found = left_out(np.full(count, AMOUNT), 5e-5)
        assert found == pytest.approx(jolts.MODES * SIZE * AMOUNT, rel=1e-12)


@pytest.mark.parametrize(
    "periods, expected", [(0.5, 2.0 / np.pi), (1.0, 0.0), (1.5, 2.0 / (3.0 * np.pi))]
)
def test_a_ramp_leaves_out_less(periods, expected):
    """|sin(pi r)| / (pi r) of the static deflection after a ramp of r periods (Biggs, Introduction
    to Structural Dynamics, 1964, section 2.6)."""
    count = 400
    ramp = AMOUNT * (np.arange(count) + 0.5) / count
    found = left_out(np.append(ramp, np.full(3, AMOUNT)), periods * PERIOD / count)
    assert found / (jolts.MODES * SIZE * AMOUNT) == pytest.approx(expected, abs=1e-4)


def test_a_thrust_curve_leaves_out_what_it_starts_with():
    """A Gaussian of 4 ms that begins at three widths: its value there is left out, 1.1 % of the
    peak, the rest follows as in statics."""
    time = np.arange(0.0, 24e-3, 5e-5) + 2.5e-5
    found = left_out(AMOUNT * np.exp(-0.5 * ((time - 12e-3) / 4e-3) ** 2), 5e-5)
    assert found == pytest.approx(jolts.MODES * SIZE * AMOUNT * np.exp(-4.5), rel=0.1)
