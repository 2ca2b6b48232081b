"""What neglected modes would do: their motion under the forces of a run against closed forms."""

import numpy as np
import pytest
from scipy import signal

from tipoff.kernels.jit import entry
from tipoff.lowfi import modes
from tipoff.lowfi.contact.compliant import neglected
from tipoff.mechanics.rail_compliance import PATTERNS

OMEGA = 2.0 * np.pi * 3000.0  # 1/s


@entry
def drive(record, forces, dt, found):
    for i in range(forces.size):
        mode = record.modes[0, 0]
        neglected.drive(mode, dt, forces[i])
        found[i, 0], found[i, 1] = neglected.energy(mode), mode.amplitude


def driven(record: neglected.Neglected, forces: np.ndarray, dt: float) -> np.ndarray:
    """Energy (J) and amplitude after each of ``forces`` (n,), ``dt`` (s) apart."""
    found = np.zeros((forces.size, 2))
    drive(record, forces, dt, found)
    return found


def mode(drag: float = 0.0) -> neglected.Neglected:
    """One mode of one rail under one face."""
    shape = np.zeros((1, 1, 1, 4, PATTERNS))
    return neglected.build(np.array([[OMEGA**2]]), np.array([[drag]]), shape)


@pytest.mark.parametrize("cycles", [0.1, 0.3, 0.8, 1.0, 1.5, 2.2, 6.0])
def test_what_a_half_sine_leaves_in_a_mode(cycles):
    """The residual shock spectrum of a half-sine as long as so many periods of the mode; it is zero
    where that is 1.5, and 1.57 at its largest, near 0.8."""
    duration = 2.0 * np.pi * cycles / OMEGA
    forces = np.sin(np.linspace(0.0, np.pi, 2001))[1:]
    energy = driven(mode(), forces, duration / forces.size)[-1, 0]
    exact = abs(4.0 * cycles * np.cos(np.pi * cycles) / (1.0 - 4.0 * cycles**2))
    assert OMEGA * np.sqrt(2.0 * energy) == pytest.approx(exact, rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 1.0, 2.0])
def test_forces_between_the_ends_of_steps_are_linear(ratio):
    """Against the exact discrete answer of scipy, in steps of any length."""
    drag, dt = 2.0 * ratio * OMEGA, 0.8 / OMEGA
    forces = np.random.default_rng(3).standard_normal(60)
    forces[0] = 0.0
    system = signal.StateSpace(
        [[0.0, 1.0], [-(OMEGA**2), -drag]], [[0.0], [1.0]], [[OMEGA**2, 0.0]], [[0.0]]
    )
    exact = signal.lsim(system, forces, dt * np.arange(forces.size))[1]
    found = OMEGA**2 * driven(mode(drag), forces[1:], dt)[:, 1]
    assert found == pytest.approx(exact[1:], abs=1e-6 * np.abs(exact).max())


@pytest.mark.parametrize(
    "shares, count", [((0.4, 0.3), 0), ((0.9, 0.4), 1), ((2.0, 0.1, 1.5, 0.2, 0.3), 3), ((3.0,), 1)]
)
def test_the_fewest_modes_that_leave_less_than_the_threshold(shares, count):
    assert modes.needed(modes.THRESHOLD * np.array(shares)) == count
