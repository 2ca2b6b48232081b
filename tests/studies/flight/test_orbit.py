"""Relative motion in orbit: the exponential of its equations, two bodies integrated side by side,
and known paths."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tipoff.scenes import load
from tipoff.studies.flight import orbit

N = 1.1e-3
PERIOD = 2.0 * math.pi / N


@pytest.mark.parametrize("time", [0.0, 1e-3, 10.0, 0.3 * PERIOD, 2.7 * PERIOD])
def test_transition_is_the_exponential_of_the_equations(time):
    equations = np.zeros((6, 6))
    equations[:3, 3:] = np.eye(3)
    equations[3, [0, 4]], equations[4, 3], equations[5, 2] = (
        (3.0 * N**2, 2.0 * N),
        -2.0 * N,
        -(N**2),
    )
    # lengths as they are, velocities over n: entries of one size
    units = np.diag([1.0] * 3 + [N] * 3)
    scaled = np.linalg.inv(units) @ orbit.transition(N, time) @ units
    assert scaled == pytest.approx(np.linalg.inv(units) @ expm(equations * time) @ units, abs=1e-11)


def two_bodies(state, time):
    """Relative state after ``time``, both bodies integrated about a centre with mu = a = n = 1, in
    turning orbit axes."""

    def slope(_, y):
        return np.r_[y[3:], -y[:3] / np.linalg.norm(y[:3]) ** 3]

    def flown(place, velocity):
        return solve_ivp(
            slope, (0.0, time), np.r_[place, velocity], method="DOP853", rtol=1e-13, atol=1e-16
        ).y[:3, -1]

    chief = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    apart = flown(
        chief[0] + state[:3], chief[1] + state[3:] + np.cross([0.0, 0.0, 1.0], state[:3])
    ) - flown(*chief)
    c, s = math.cos(time), math.sin(time)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ apart


@pytest.mark.parametrize("time", [0.5, 2.0, 2.0 * math.pi])
def test_error_falls_as_the_square_of_the_distance(time):
    """Control: the straight line is wrong by as large a part however short the distance: its error
    falls as the distance."""
    state = np.array([0.3, -0.5, 0.2, 0.1, 0.4, -0.3])
    sizes = 2.0 ** -np.arange(6.0, 14.0)
    exact = np.array([two_bodies(size * state, time) for size in sizes])
    linear = np.array([orbit.transition(1.0, time)[:3] @ (size * state) for size in sizes])
    straight = np.array([size * (state[:3] + time * state[3:]) for size in sizes])
    slopes = [
        np.polyfit(np.log(sizes), np.log(np.linalg.norm(found - exact, axis=1)), 1)[0]
        for found in (linear, straight)
    ]
    assert slopes == pytest.approx([2.0, 1.0], abs=0.05)


def test_known_paths():
    def places(state, time):
        return orbit.places(N, np.array([state], dtype=float), np.atleast_1d(time)[None])[0]

    whole = np.linspace(0.0, PERIOD, 9)
    # y' = -2 n x: an ellipse twice as long as high
    closed = places([10.0, 0.0, 3.0, 0.0, -20.0 * N, 0.0], whole)
    assert closed[-1] == pytest.approx(closed[0], abs=1e-11)
    assert closed[2] == pytest.approx([0.0, -20.0, 0.0], abs=1e-11) and closed[4] == pytest.approx(
        [-10.0, 0.0, -3.0], abs=1e-11
    )
    # control: it drifts away
    assert places([10.0, 0.0, 0.0, 0.0, 0.0, 0.0], PERIOD)[0, 1] == pytest.approx(
        -12.0 * math.pi * 10.0
    )
    same = places([0.0, 7.0, 0.0, 0.0, 0.0, 0.0], whole)  # behind each other: it stays
    assert same == pytest.approx(np.tile([0.0, 7.0, 0.0], (9, 1)))
    assert places([0.0, 0.0, 0.0, 0.0, 2.0, 0.0], PERIOD)[0] == pytest.approx(
        [0.0, -3.0 * 2.0 * PERIOD, 0.0], abs=1e-8
    )
    # radially: it comes back
    assert places([0.0, 0.0, 0.0, 2.0, 0.0, 5.0], PERIOD)[0] == pytest.approx(
        [0.0, 0.0, 0.0], abs=1e-8
    )
    assert places([0.0, 0.0, 0.0, 2.0, 0.0, 0.0], PERIOD / 2.0)[0] == pytest.approx(
        [0.0, -8.0 / N, 0.0], abs=1e-8
    )


def test_free_fall_is_straight_but_for_the_gradient_of_gravity():
    """In the axes a scene has. Control: places left in orbit axes are off by the turning of
    these."""
    angles = {"flight.azimuth": "20 deg", "flight.elevation": "-50 deg", "flight.roll": "70 deg"}
    axes = load("reference").replace(angles).flight.record().axes
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-15) and np.linalg.det(
        axes
    ) == pytest.approx(1.0)
    place, velocity, time = (
        np.array([[0.3, -0.1, 0.2]]),
        np.array([[6.0, 0.02, -0.01]]),
        np.array([[0.0, 5.0, 10.0]]),
    )
    turned = orbit.places(N, orbit.state(N, axes, place, velocity), time)
    straight = place[:, None] + velocity[:, None] * time[..., None]
    off = np.linalg.norm(orbit.back(N, axes, turned, time) - straight, axis=2)[0]
    assert (off <= 1.5 * N**2 * time[0] ** 2 * 61.0 + 1e-12).all()
    assert np.linalg.norm(turned @ axes - straight, axis=2)[0, -1] > 100.0 * off[-1] / 20.0


@pytest.mark.parametrize(
    "angles, expected",
    [
        ({}, [0.0, 1.0, 0.0]),
        ({"azimuth": "90 deg"}, [0.0, 0.0, 1.0]),
        ({"elevation": "90 deg"}, [1.0, 0.0, 0.0]),
        ({"azimuth": "180 deg"}, [0.0, -1.0, 0.0]),
        ({"roll": "90 deg"}, [0.0, 1.0, 0.0]),
    ],
)
def test_launch_axis(angles, expected):
    axes = (
        load("reference")
        .replace({f"flight.{key}": value for key, value in angles.items()})
        .flight.record()
        .axes
    )
    assert axes[:, 0] == pytest.approx(expected, abs=1e-15)
    if "roll" in angles:
        # y, which was the orbit's normal, points outwards
        assert axes[:, 1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-15)
