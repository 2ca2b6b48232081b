"""The rates of a rocket on a pin against a body on a fixed point."""

import numpy as np
import pytest

from tipoff.mechanics.estimates import pin
from tipoff.scenes import load, scene_model


@pytest.mark.parametrize("clock", ["0 deg", "50 deg"])
def test_a_tilted_thrust_through_the_pin_does_not_turn_it(clock):
    """Impulse about the fixed point over the inertia about it, by vectors from there. Control: the moment about the
    mass centre alone is several times as large."""
    tilt = {"axial": "1 deg", "radial": clock}
    scene = load("rocket_rail").replace({"thrust_offset.misalignment": tilt, "gravity": None})
    model = scene_model.build(scene)
    arm, inertia = scene.thrust.arm, np.diag(model.payload.inertia)
    for behind in (arm, 0.6 * arm, 0.3 * arm):
        fixed = np.array([-behind, 0.0, 0.0])
        turn = 7.0 * np.cross(
            np.array(model.thrust_offset.arm) - fixed, model.thrust_offset.direction
        )
        exact = np.append(0.0, (turn / (inertia + model.payload.mass * behind**2))[1:])
        found = pin.rates(model, behind, 7.0, 0.1)
        assert found == pytest.approx(exact, rel=1e-12, abs=1e-15)
    # Control:
    own = 7.0 * np.cross(model.thrust_offset.arm, model.thrust_offset.direction)
    assert np.linalg.norm(own) > 1.3 * np.linalg.norm(turn)


def test_gravity_turns_it_by_its_moment_about_the_pin():
    scene = load("rocket_rail").replace({"thrust_offset": None})
    model = scene_model.build(scene)
    mass, inertia = scene.payload.mass, scene.payload.inertia.yy
    exact = -mass * scene.gravity.z * 0.65 * 0.1 / (inertia + mass * 0.65**2)
    assert pin.rates(model, 0.65, 7.0, 0.1) == pytest.approx((0.0, exact, 0.0), rel=1e-12)
