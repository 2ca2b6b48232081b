"""A payload that rests on flexible rails at ignition (``initial.settled``)."""

import numpy as np
import pytest

from tests.highfi.support import COARSE, tiny
from tipoff import highfi

G, START = 9.80665, 1.9e-3
CHANGED = {
    "platform": None,
    "thrust_offset": None,
    "duration": 2e-3,
    "gravity": {"y": -0.4 * G, "z": -G},
    "thrust": {"kind": "constant", "force": 3000.0, "start": START, "duration": 0.02},
}


@pytest.mark.case("O90")
@pytest.mark.slow
def test_a_payload_on_flexible_rails_stays_at_rest():
    """Control: without the option it
    falls."""
    asked = tiny(**CHANGED, initial={"settled": True})
    run = highfi.run(asked, COARSE)
    before = run.time < START
    assert run.message == "" and run.cost["settling_steps"] > 0
    assert np.abs(run.velocity[before, 1:]).max() < 1e-7
    assert np.abs(run.velocity[before, 0]).max() < 1e-5
    assert np.degrees(np.abs(run.rate[before]).max()) < 1e-3
    force = run.pad_force.sum(axis=1)[before] / asked.payload.mass
    np.testing.assert_allclose(force[:, 1:], [[0.4 * G, G]] * before.sum(), rtol=1e-4)
    np.testing.assert_allclose(force[0, 1:], [0.4 * G, G], rtol=1e-5)
    falling = highfi.run(tiny(**CHANGED), COARSE)
    assert np.abs(falling.velocity[before, 2]).max() > 0.01
    assert not falling.pad_force[before].any()


@pytest.mark.slow
def test_a_payload_rests_on_an_inclined_rail_that_holds_it():
    """The latch acts beside the mass centre, so its moment tilts the payload."""
    steep = {"gravity": {"x": -0.9 * G, "y": -0.1 * G, "z": -0.4 * G}}
    offset = {"eccentricity": {"axial": 0.002, "radial": 0.0}}
    held = {"hold_down": {"release": 2000.0}, "mass_offset": offset}
    asked = tiny(**CHANGED | steep | held, initial={"settled": True})
    run = highfi.run(asked, COARSE)
    before = run.time < START
    assert np.abs(run.velocity[before]).max() < 1e-6
    assert np.degrees(np.abs(run.rate[before]).max()) < 1e-3
    force = run.pad_force.sum(axis=1)[before] / asked.payload.mass
    np.testing.assert_allclose(force[:, 1:], [[0.1 * G, 0.4 * G]] * before.sum(), rtol=1e-3)
