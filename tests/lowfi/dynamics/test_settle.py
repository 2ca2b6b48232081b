"""A payload that rests on its rails at ignition (``initial.settled``)."""

import numpy as np
import pytest

import tipoff
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import PAPER_PAD, G, corners, scene
from tipoff import lowfi, scenes
from tipoff.lowfi import Numerics
from tipoff.lowfi.dynamics import settle

MASS, START = 20.0, 5e-3  # kg; s, start of the thrust
SETTLED = {"initial": {"settled": True}}
LATE = {"kind": "constant", "force": 500.0, "start": START, "duration": 0.1}
RUBBING = {"static": 0.3, "dynamic": 0.2, "static_speed": 0.01, "dynamic_speed": 0.02}
WEIGHT = {"x": 0.0, "y": -0.4 * G, "z": -G}
FIXED = {"platform": None, "thrust_offset": None, "thrust": LATE, "duration": 0.01}


def on_springs(**tables):
    changed = {"gravity": WEIGHT, "friction": RUBBING, "contact": PAPER_PAD, "thrust": LATE}
    return scene(0.01, 1e-4, mass=MASS, **{"pads": corners()} | changed | tables)


def before_thrust(run) -> np.ndarray:
    return run.time < START


def sums(run, asked) -> np.ndarray:
    """(n,3) contact force over mass, m/s2."""
    return run.pad_force.sum(axis=1)[before_thrust(run)] / asked.payload.mass


@pytest.mark.case("O90")
def test_a_payload_on_springs_stays_at_rest():
    """It sinks as the law of the paper's pad demands."""
    asked = on_springs(**SETTLED)
    run = lowfi.run(asked, "springs")
    before = before_thrust(run)
    assert run.message == "" and np.abs(run.velocity[before]).max() < 1e-12
    assert np.abs(run.rate[before]).max() < 1e-12
    np.testing.assert_allclose(sums(run, asked), [[0.0, 0.4 * G, G]] * before.sum(), atol=1e-8)
    for axis, pull in ((1, 0.4 * G), (2, G)):
        sink = (MASS * pull / 4.0 / PAPER_PAD["stiffness"]) ** (1.0 / 1.5)
        place = -PAPER_PAD["clearance"] - sink
        assert run.position[0, axis] == pytest.approx(place, rel=1e-9)
    # Control: a payload that begins in the middle falls, and its pads bounce.
    falling = lowfi.run(on_springs(), "springs")
    assert np.abs(falling.velocity[before][:, 2]).max() > 5e-3
    assert sums(falling, asked)[:, 2].max() > 2.0 * G


def test_a_mass_centre_beside_the_middle_is_balanced():
    """Forces and moments of the pads against those of the weight."""
    offset = {"eccentricity": {"axial": 0.02, "radial": 2.0}}
    asked = on_springs(mass_offset=offset, **SETTLED)
    run = lowfi.run(asked, "springs")
    before = before_thrust(run)
    assert np.abs(run.rate[before]).max() < 1e-10
    np.testing.assert_allclose(sums(run, asked)[0], [0.0, 0.4 * G, G], atol=1e-7)
    pads = np.array([pad.position for pad in asked.pads for _ in pad.normals])
    moment = np.cross(pads - run.position[0], run.pad_force[0]).sum(axis=0)
    assert np.abs(moment).max() < 1e-3 * MASS * G * 0.02
    loads = run.pad_force[0][:, 2]
    assert np.ptp(loads[loads > 0.0]) > 0.05 * MASS * G  # control: they are not equal


def test_a_payload_rests_on_an_inclined_rail_that_holds_it():
    """The latch carries the weight along the rail, and its moment about a mass centre beside the
    line, and so does a stop. Control: with a release at ignition the payload slides back."""
    offset = {"eccentricity": {"axial": 0.02, "radial": 2.0}}
    steep = {"gravity": {"x": -0.9 * G, "y": 0.0, "z": -0.4 * G}, "mass_offset": offset}
    asked = on_springs(hold_down={"release": 400.0}, **SETTLED, **steep)
    for held in (asked, asked.replace({"hold_down": None})):
        run = lowfi.run(held, "springs")
        before = before_thrust(run)
        assert np.abs(run.velocity[before]).max() < 1e-11
        assert np.abs(run.rate[before]).max() < 1e-10
        np.testing.assert_allclose(sums(run, asked)[:, 2], 0.4 * G, rtol=1e-8)
    sliding = lowfi.run(asked.replace({"hold_down.release": 0.0}), "springs")
    assert sliding.velocity[before][-1, 0] < -0.02


def test_cases_rest_too():
    asked = on_springs(**SETTLED)
    rows = [{"payload.mass": 20.0}, {"payload.mass": 30.0}]
    found = lowfi.run_many(asked, rows, "springs")
    steps = [lowfi.run(asked.replace(row), "springs").cost["steps"] for row in rows]
    assert found.steps.values.tolist() == steps
    assert not any("press" in str(text) for text in found.message.values)


@pytest.mark.slow
@pytest.mark.parametrize("modes", [0, 4])
def test_a_payload_on_compliant_rails_stays_at_rest(modes):
    """Along the rail it creeps by the small axial force of a bent rail. Control: without the
    option it falls."""
    changed = FIXED | {"gravity": WEIGHT}
    asked = REFERENCE.replace(changed | {"initial.settled": True})
    numerics = Numerics(modes=modes)
    run = lowfi.run(asked, compliance=reference_compliance(), numerics=numerics)
    before = before_thrust(run)
    assert np.abs(run.velocity[before, 1:]).max() < 1e-7
    assert np.abs(run.velocity[before, 0]).max() < 1e-5
    assert np.degrees(np.abs(run.rate[before]).max()) < 1e-3
    np.testing.assert_allclose(sums(run, asked)[:, 1:], [[0.4 * G, G]] * before.sum(), rtol=1e-4)
    np.testing.assert_allclose(sums(run, asked)[0, 1:], [0.4 * G, G], rtol=1e-8)
    falling = lowfi.run(REFERENCE.replace(changed), compliance=reference_compliance())
    assert np.abs(falling.velocity[before, 2]).max() > 0.01


@pytest.mark.parametrize("gradient", [None, {"y": 20.0}])
def test_a_payload_that_is_free_to_slide_across_its_rail_stays(gradient, monkeypatch):
    """Under a weight along Z, with its mass centre to one side: the tilt of its pads leaves a small force along
    Y. Corrections followed it from wall to wall, and the scene was refused. All 400 were made."""
    calls, forces = [], settle.forces
    monkeypatch.setattr(settle, "forces", lambda *given: (calls.append(1), forces(*given)))
    warm = {"thermal": {"mean": 5.0, "gradient": gradient}, "rail.material.expansion": 23.6e-6}
    beside = {"eccentricity": {"axial": 1e-4, "radial": np.radians(120.0)}}
    changed = FIXED | {"gravity": {"z": -G}, "mass_offset": beside, "rail.mount_stiffness": None}
    asked = scenes.load("tiny").replace(changed | SETTLED | (warm if gradient else {}))
    run = lowfi.run(asked, compliance=tipoff.compliance(asked, 0.016), numerics=Numerics(modes=0))
    before = before_thrust(run)
    # its pads stay where they are across the rail, so the mass centre is to their side
    assert run.message == "" and run.position[0, 1] == pytest.approx(
        1e-4 * np.sin(np.radians(60.0)), abs=5e-6
    )
    np.testing.assert_allclose(sums(run, asked)[:, 2], G, rtol=1e-5)
    assert len(calls) < 1000  # six or seven for a correction
    assert np.abs(run.velocity[before, 1]).max() < 1e-3 * G * START
    assert np.abs(run.velocity[before, 2]).max() < 1e-7


def test_a_button_that_hardly_presses_rests_too():
    """A rocket on two buttons, one of which carries nearly nothing: full corrections went to and fro about
    its first contact, and the scene was refused."""
    asked = scenes.load("rocket_rail").replace({"initial.settled": True, "duration": 1e-3})
    run = lowfi.run(asked, compliance=tipoff.compliance(asked, 0.02), numerics=Numerics(modes=0))
    across = run.pad_force[0].sum(axis=0)[2] / asked.payload.mass
    assert across == pytest.approx(0.8547, rel=1e-6)
