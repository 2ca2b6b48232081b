"""Free rotation of a rigid body by the steps of the reference, against Jacobi's elliptic functions."""

import numpy as np
import pytest

from tests.exact.rigid import free_rates
from tipoff.highfi.state import records
from tipoff.highfi.state.pose import drift_body
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel

INERTIA, RATE = (0.30, 0.55, 0.80), (0.5, 0.0, 2.0)  # kg m2, rad/s
pytestmark = pytest.mark.case("O34")


@kernel
def _turn(body, inverse_inertia, dt, steps):
    for _ in range(steps):
        drift_body(body, inverse_inertia, dt)


@kernel
def _turn_by_the_first_rate(body, inverse_inertia, dt, steps):
    for _ in range(steps):
        q = (body.quaternion[0], body.quaternion[1], body.quaternion[2], body.quaternion[3])
        spin = (body.spin[0], body.spin[1], body.spin[2])
        rate = rotation.angular_velocity(rotation.matrix(q), inverse_inertia, spin)
        end = rotation.step(q, rate, dt)
        for i in range(4):
            body.quaternion[i] = end[i]


def _rate(turn, dt: float, steps: int) -> np.ndarray:
    """Body rates (3,) rad/s after so many steps."""
    body = records.Body(
        position=np.zeros(3),
        velocity=np.zeros(3),
        quaternion=np.array([1.0, 0.0, 0.0, 0.0]),
        spin=np.multiply(INERTIA, RATE),
    )
    turn(body, np.diag(np.reciprocal(INERTIA)), dt, steps)
    axes = rotation.matrices(body.quaternion[None])[0]
    return axes.T @ body.spin / INERTIA


def _exact(time: float) -> np.ndarray:
    return free_rates(INERTIA, RATE, np.array([time]))[0]


def test_a_million_steps_add_no_rounding_that_counts():
    """The angular momentum is a constant of each step, so nothing but attitude can drift."""
    assert _rate(_turn, 1e-6, 10**6) == pytest.approx(_exact(1.0), rel=1e-10)


def test_attitude_is_of_order_two_and_by_the_first_rate_of_order_one():
    for turn, order in ((_turn, 2), (_turn_by_the_first_rate, 1)):
        coarse, fine = (
            np.abs(_rate(turn, 1.0 / steps, steps) - _exact(1.0)).max() for steps in (500, 1000)
        )
        assert np.log2(coarse / fine) == pytest.approx(order, abs=0.1)
