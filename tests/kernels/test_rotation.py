"""Quaternions and matrices against scipy, and the exactness of `step`."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tipoff.kernels import rotation

NUMBER = st.floats(-10.0, 10.0, allow_nan=False)
TRIPLE = st.tuples(NUMBER, NUMBER, NUMBER)


def scipy(q) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


def same(p, q) -> bool:
    """Same rotation, whichever sign."""
    return min(np.abs(np.subtract(p, q)).max(), np.abs(np.add(p, q)).max()) < 1e-14


@settings(deadline=None)  # the first call compiles
@given(TRIPLE, TRIPLE, TRIPLE)
def test_against_scipy(a, b, v):
    p, q = rotation.exponential(a), rotation.exponential(b)
    assert same(p, Rotation.from_rotvec(a).as_quat(scalar_first=True))
    assert same(rotation.product(p, q), (scipy(p) * scipy(q)).as_quat(scalar_first=True))
    m = rotation.matrix(p)
    assert np.allclose(np.reshape(m, (3, 3)), scipy(p).as_matrix(), atol=1e-14)
    assert np.allclose(rotation.rotate(m, v), scipy(p).apply(v), atol=1e-13)
    assert np.allclose(rotation.unrotate(m, v), scipy(p).inv().apply(v), atol=1e-13)
    assert np.allclose(rotation.cross(a, v), np.cross(a, v), atol=1e-13)
    assert rotation.dot(a, v) == pytest.approx(np.dot(a, v), abs=1e-12)


@settings(deadline=None)  # the first call compiles
@given(TRIPLE, TRIPLE, st.floats(0.0, 0.1))
def test_step_is_a_turn_about_inertial_axes(start, rate, dt):
    q = rotation.exponential(start)
    expected = Rotation.from_rotvec(np.multiply(rate, dt)) * scipy(q)
    assert same(rotation.step(q, rate, dt), expected.as_quat(scalar_first=True))


def test_many_steps_are_one_turn_and_stay_of_unit_norm():
    """Exact at any step: 10,000 steps or one give the same attitude, to the rounding of 10,000
    products."""
    rate, q = (1.0, -2.0, 0.5), (1.0, 0.0, 0.0, 0.0)
    for _ in range(10_000):
        q = rotation.step(q, rate, 1e-3)
    once = rotation.step((1.0, 0.0, 0.0, 0.0), rate, 10.0)
    assert abs(abs(np.dot(q, once)) - 1.0) < 1e-15
    assert np.abs(np.abs(q) - np.abs(once)).max() < 1e-12
    assert abs(np.linalg.norm(q) - 1.0) < 1e-15


def test_a_first_order_step_would_not():
    """Control: q + dt/2 w q, even normalised, turns by atan(dt w / 2) instead of dt w / 2."""
    q, dt = np.array([1.0, 0.0, 0.0, 0.0]), 1e-2
    for _ in range(1000):
        q = np.array(
            rotation.normalised(
                tuple(q + 0.5 * dt * np.array(rotation.product((0.0, 0.0, 0.0, 2.0), tuple(q))))
            )
        )
    assert not np.allclose(np.abs(q), np.abs(rotation.exponential((0.0, 0.0, 20.0))), atol=1e-4)


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-12, 0.99e-4, 1.01e-4, 1e-3])
def test_small_angles(angle):
    """On both sides of the switch to the series."""
    assert rotation.exponential((angle, 0.0, 0.0))[1] == pytest.approx(
        np.sin(0.5 * angle), rel=1e-15, abs=0.0
    )


def test_angular_velocity():
    rng = np.random.default_rng(5)
    root = rng.normal(size=(3, 3))
    inertia, q, rate = (
        root @ root.T + np.eye(3),
        rotation.exponential((0.3, -1.0, 2.0)),
        np.array([1.0, 2.0, 3.0]),
    )
    body = scipy(q).as_matrix()
    momentum = body @ inertia @ body.T @ rate
    found = rotation.angular_velocity(rotation.matrix(q), np.linalg.inv(inertia), tuple(momentum))
    assert np.allclose(found, rate, rtol=1e-12)


def test_a_matrix_times_a_triple_and_back():
    root = np.random.default_rng(7).normal(size=(3, 3))
    matrix, x = root @ root.T + np.eye(3), (1.0, -2.0, 3.0)
    product = rotation.multiply(matrix, x)
    assert np.allclose(product, matrix @ x, rtol=1e-14)
    assert np.allclose(rotation.solve(*map(tuple, matrix), product), x, rtol=1e-12)


def test_arrays_of_matrices():
    turns = Rotation.random(50, rng=np.random.default_rng(6))
    assert np.allclose(
        rotation.matrices(turns.as_quat(scalar_first=True)), turns.as_matrix(), atol=1e-15
    )


@pytest.mark.parametrize(
    "turn", [(0.0, 0.0, 0.0), (1e-14, -2e-14, 0.0), (0.3, -0.4, 1.2), (0.0, 0.0, -3.1)]
)
def test_rotation_vector_is_the_inverse_of_the_exponential(turn):
    q = np.array(rotation.exponential(turn))
    assert rotation.vector(q) == pytest.approx(turn, rel=1e-13, abs=1e-300)
    assert rotation.vector(-q) == pytest.approx(turn, rel=1e-13, abs=1e-300)  # the same attitude
