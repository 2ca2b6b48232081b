"""Separation of boxes against the distance that a quadratic programme finds, and where it is
exact."""

import math

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.spatial.transform import Rotation

from tipoff.studies.flight import boxes

HALF, OTHER = np.array([0.3, 0.1, 0.2]), np.array([0.15, 0.25, 0.05])


def distance(turn, centre, half, other):
    """Least distance of two boxes: the nearest points are a linear least squares problem with
    bounds."""
    found = lsq_linear(
        np.hstack([turn * half, -np.diag(other)]), -centre, bounds=(-1.0, 1.0), tol=1e-14
    )
    return math.sqrt(2.0 * found.cost)


def test_a_box_that_is_called_clear_is_clear():
    """Never more than the distance, never positive in an overlap; the distance itself in most poses
    near a touch."""
    rng = np.random.default_rng(2)
    turns = Rotation.random(300, rng=rng).as_matrix()
    centres = rng.uniform(-0.5, 0.5, (300, 3))
    found = boxes.separation(turns, centres, HALF, OTHER)
    exact = np.array([distance(turn, centre, HALF, OTHER) for turn, centre in zip(turns, centres)])
    assert (found <= exact + 1e-7).all()
    assert (found > 0.0).tolist() == (exact > 1e-6).tolist() and 50 < (found > 0.0).sum() < 250
    assert (found > exact - 1e-6)[found > 0.0].mean() > 0.3
    # Control: the centres alone would call some that overlap clear, and spheres about the boxes
    # some that are clear in touch.
    spheres = np.linalg.norm(centres, axis=1) - np.linalg.norm(HALF) - np.linalg.norm(OTHER)
    assert (spheres[found > 0.0] < 0.0).any()


@pytest.mark.parametrize(
    "turn, centre, expected",
    [
        ([0.0, 0.0, 0.0], [0.5, 0.0, 0.0], 0.05),
        ([0.0, 0.0, 0.0], [0.44, 0.1, 0.0], -0.01),
        ([0.0, 0.0, 0.0], [0.0, 0.36, 0.1], 0.01),
        # an edge before a face
        ([0.0, 0.0, math.pi / 4.0], [0.15 + 0.4 / math.sqrt(2.0) + 0.02, 0.0, 0.0], 0.02),
        ([0.0, 0.0, math.pi / 4.0], [0.15 + 0.4 / math.sqrt(2.0) - 0.02, 0.0, 0.0], -0.02),
    ],
)
def test_known_separations(turn, centre, expected):
    found = boxes.separation(Rotation.from_rotvec(turn).as_matrix(), np.array(centre), HALF, OTHER)
    assert found == pytest.approx(expected, abs=1e-14)


def test_crossed_edges():
    """Two bars across each other, each on its edge: only the product of their edges parts them.
    Control: the faces overlap."""
    first, bar = (
        Rotation.from_euler("xz", [45.0, 90.0], degrees=True).as_matrix(),
        np.array([1.0, 0.1, 0.1]),
    )
    second = Rotation.from_euler("x", 45.0, degrees=True).as_matrix()
    height = 0.2 * math.sqrt(2.0) + 0.01
    turn, centre = second.T @ first, second.T @ np.array([0.0, 0.0, height])
    assert boxes.separation(turn, centre, bar, bar) == pytest.approx(0.01, abs=1e-14)
    faces = (abs(centre) - bar - abs(turn) @ bar).max()
    assert faces < 0.0


def test_depth_of_overlap_is_the_shortest_way_out():
    rng = np.random.default_rng(3)
    turn, centre = Rotation.random(rng=rng).as_matrix(), np.array([0.05, -0.04, 0.03])
    depth = -boxes.separation(turn, centre, HALF, OTHER)
    assert depth > 0.01
    ways = rng.normal(size=(2000, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    moved = boxes.separation(turn, centre + 0.999 * depth * ways, HALF, OTHER)
    assert (moved < 0.0).all()  # no way so short leads out
    assert (boxes.separation(turn, centre + 1.02 * depth * ways, HALF, OTHER) > 0.0).any()


def test_least_of_many_functions():
    """Minima inside, and at either end."""
    lowest = np.array([0.3141, -1.0, 2.0])
    value, time = boxes.least(
        lambda t: (t - lowest[:, None]) ** 2 - 1.0, np.zeros(3), np.ones(3), 50, 2
    )
    assert time == pytest.approx([0.3141, 0.0, 1.0], abs=4e-4)
    assert value == pytest.approx([-1.0, 0.0, 0.0], abs=2e-7)
