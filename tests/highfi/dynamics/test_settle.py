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


@pytest.mark.slow
def test_a_payload_that_nothing_holds_along_its_rail_rests_across_it():
    """Down a slope, without a latch: it slides from ignition on. Each look at its energy had the speed of
    the steps since the last one, so it never came to rest."""
    steep = {"gravity": {"x": 0.7 * G, "y": -0.3 * G, "z": -0.6 * G}}
    asked = tiny(**CHANGED | steep, friction=None, initial={"settled": True})
    run = highfi.run(asked, COARSE)
    before = run.time < START
    assert run.cost["settling_steps"] < 200_000
    assert run.velocity[before, 0] == pytest.approx(0.7 * G * run.time[before], abs=1e-4)
    assert np.abs(run.velocity[before, 1:]).max() < 1e-5
    force = run.pad_force.sum(axis=1)[before] / asked.payload.mass
    np.testing.assert_allclose(force[:, 1:], [[0.3 * G, 0.6 * G]] * before.sum(), rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [True, False])
def test_a_payload_that_is_free_to_slide_across_its_rail_stays(friction):
    """Under a weight along Z, on rails that are warmer on one side: the tilt of its pads would let it slide
    along Y for seconds, and it was refused after five million steps."""
    offset = {"eccentricity": {"axial": 1e-4, "radial": np.radians(120.0)}}
    warm = {"thermal": {"mean": 5.0, "gradient": {"y": 20.0}}, "rail__material__expansion": 23.6e-6}
    flat = {"gravity": {"z": -G}, "mass_offset": offset} | warm
    changed = {} if friction else {"friction": None}
    asked = tiny(**CHANGED | flat | changed, initial={"settled": True})
    run = highfi.run(asked, COARSE)
    before = run.time < START
    assert run.cost["settling_steps"] < 200_000
    assert np.abs(run.velocity[before]).max() < 1e-3 * G * START
    force = run.pad_force.sum(axis=1)[before] / asked.payload.mass
    np.testing.assert_allclose(force[:, 2], G, rtol=1e-3)
    assert np.abs(force[:, 1]).max() < 1e-3 * G
