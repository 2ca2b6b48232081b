"""O32: payload and free platform through contact and friction alone, over a hundred thousand steps.
Nothing acts from outside."""

import numpy as np
import pytest

from tests.lowfi.support import PAPER_PAD, corners, scene, unwatched
from tipoff import lowfi
from tipoff.kernels import rotation
from tipoff.scenes import scene_model
from validation import oracle

# Undamped pads and little friction, so that the payload goes on rattling in a rail that has no end.
RATTLING = {
    "mass": 9.9,
    "inertia": {"xx": 0.066, "yy": 0.134, "zz": 0.128, "xy": 0.004, "xz": -0.002},
    "pads": corners(0.08),
    "platform": {
        "mass": 81.2,
        "inertia": {"xx": 4.9, "yy": 4.9, "zz": 4.9},
        "mass_centre": {"x": -0.1},
    },
    "contact": PAPER_PAD | {"clearance": 1e-4, "damping": 0.0},
    "friction": {"static": 0.02, "dynamic": 0.02, "static_speed": 0.01, "dynamic_speed": 0.02},
    "thrust": {"kind": "gaussian", "peak": 0.0, "width": 1.0, "centre": 1.0},
    "thrust_offset": {"misalignment": {"axial": 0.001}},
    "initial": {
        "velocity": {"x": 0.5, "y": 0.05, "z": -0.03},
        "rate": {"x": 0.3, "y": -0.2, "z": 0.1},
        "platform_rate": {"y": 0.01},
    },
}


def angular_momentum(asked, rows: np.ndarray) -> np.ndarray:
    """Total angular momentum (n,3) about the scene's origin of states (n,26) of the plain
    rewrite."""
    model, total = scene_model.build(asked), 0.0
    for body, row in ((model.payload, rows[:, :13]), (model.platform, rows[:, 13:])):
        spin = np.einsum(
            "nij,jk,nk->ni", rotation.matrices(row[:, 6:10]), body.inertia, row[:, 10:13]
        )
        total = total + spin + body.mass * np.cross(row[:, 0:3], row[:, 3:6])
    return total


@pytest.mark.case("O32")
@pytest.mark.parametrize("tolerance, duration", [(1e-9, 20.0), (1e-12, 3.0)])
def test_momenta_stay_over_a_hundred_thousand_steps(tolerance, duration):
    """Linear momentum to 1e-12, angular to 1e-11 of its largest, at two step sizes; and no energy
    is lost."""
    asked = scene(duration, duration / 2000, **RATTLING)
    run = unwatched(asked, lowfi.Numerics(relative_tolerance=tolerance)).trajectory()
    assert not run.message and run.cost["steps"] > 1e5
    assert (
        run.checks["linear_momentum_error"] <= 1e-12
        and run.checks["angular_momentum_error"] <= 1e-11
    )
    assert run.checks["energy_error"] <= 1e-6 and run.checks["friction_power_max"] <= 0.0


@pytest.mark.case("O32")
def test_the_usual_state_variables_let_angular_momentum_drift():
    """Control: body rates as the state, Runge-Kutta at 50 us: in 10,000 steps the same physics
    loses more than is allowed above."""
    asked = scene(0.5, 1e-3, **RATTLING)
    job, rows = oracle.prepared(asked, 20, 500, 1e-3)
    oracle.integrate(*job, rows)
    momentum = angular_momentum(asked, rows)
    drift = np.abs(momentum - momentum[0]).max() / np.linalg.norm(momentum, axis=1).max()
    assert 1e-10 < drift < 1e-2
