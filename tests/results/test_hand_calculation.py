"""Moment impulse over inertia against runs, and the oracle that a run is for it."""

import numpy as np
import pytest

from tests.scenes import test_lugs
from tests.studies.synthetic import flight
from tipoff import lowfi
from tipoff.results import hand_calculation
from tipoff.scenes import load, parse

FREE = {"contact": None, "friction": None}


@pytest.fixture(scope="module")
def scene():
    return load("tiny").replace(FREE)


def test_one_component_is_impulse_times_arm_over_inertia():
    """Thrust along X at a height h above the mass centre turns a body without products of inertia
    about Y by I h / J_yy alone."""
    scene = load("tiny").replace(
        {
            **FREE,
            "payload.inertia.xy": None,
            "payload.inertia.xz": None,
            "thrust_offset": {"eccentricity": {"axial": "1 mm", "radial": "0 deg"}},
        }
    )
    impulse = 36e3 * 1.5e-3 * np.sqrt(2.0 * np.pi)  # of the whole pulse
    by_hand = hand_calculation.rates(scene, flight())
    assert by_hand.at == "settled" and "no pad touches" in by_hand.words
    # 0.13 % of the pulse comes before ignition
    assert by_hand.rate_rad_s == pytest.approx([0.0, 1e-3 * impulse / 0.134, 0.0], rel=2e-3)


@pytest.mark.parametrize("condition", ["phi0", "phi60", "h5", "h6", "h9"])
def test_without_contact_it_is_the_rate_of_a_run(scene, condition):
    one = scene.condition(condition)
    run = lowfi.run(one)
    found = hand_calculation.rates(one, run).rate_rad_s
    # what is left out, w x J w over half the run, is 1e-2 of the rate at 0.5 deg/s
    assert found == pytest.approx(run.outcome.rate, abs=1e-2 * np.linalg.norm(run.outcome.rate))
    assert np.linalg.norm(found) > 1e-3


def test_rates_at_ignition_are_added(scene):
    one = scene.replace({"thrust_offset": None, "initial.rate.x": "2 deg/s"})
    found = hand_calculation.rates(one, flight()).rate_rad_s
    assert found == pytest.approx([np.radians(2.0), 0.0, 0.0])


def test_one_pad_that_touches_adds_its_impulse():
    """A force f for a time T at c gives J^-1 c x f T."""
    scene = load("tiny").replace({"thrust_offset": None})
    force = np.zeros((601, 16, 3))
    force[101:200, 2, 1] = 50.0
    run = flight(pad_force=force)
    interval = run.time[1] - run.time[0]
    found = hand_calculation.rates(scene, run)
    assert "pad 2 alone touches" in found.words
    from tipoff.scenes.scene_model import build

    model = build(scene)
    moment = 50.0 * 99 * interval * np.cross(model.faces.centre[2], [0.0, 1.0, 0.0])
    assert found.rate_rad_s == pytest.approx(
        np.linalg.solve(model.payload.inertia, moment), rel=1e-9
    )


def test_two_pads_are_not_counted_by_hand():
    force = np.zeros((601, 16, 3))
    force[100:200, 2, 1] = force[300, 6, 1] = 50.0
    assert hand_calculation.rates(load("tiny"), flight(pad_force=force)) is None


@pytest.mark.parametrize("near", [False, True])
def test_a_spring_whose_lever_grows_is_not_counted_by_hand(near):
    """A spring 0.17 m behind the mass centre and 0.1 mm beside the axis: its lever grows by the turn of the
    payload, and the rate seven times. Control: a spring 1 mm beside the axis and 0.1 mm behind."""
    place = {"thrust.springs.0.z": 1e-3 if near else 1e-4, "thrust.arm": 1e-4 if near else 0.17}
    one = load("cubesat_3u").replace({**FREE, "mass_offset": None, **place})
    run = lowfi.run(one, "springs")
    found = hand_calculation.rates(one, run)
    assert (found is not None) == near
    if near:
        size = np.linalg.norm(run.outcome.rate)
        assert found.rate_rad_s == pytest.approx(run.outcome.rate, abs=0.1 * size) and size > 1e-2


@pytest.mark.parametrize("clock", ["90 deg", "270 deg"])
def test_a_rocket_turns_about_its_rear_button(clock):
    """The rate at exit across the slot, with 5 um of play and buttons that do not bounce, under a thrust that
    is tilted by 1 deg either way. Control: gravity alone has a moment of another size."""
    play = {"contact.clearance": "5 um", "initial.position.z": "-5 um", "friction": None}
    tilted = {"thrust_offset.misalignment": {"axial": "1 deg", "radial": clock}}
    one = load("rocket_rail").replace(play | tilted | {"contact.damping": "20 N*s/mm"})
    run = lowfi.run(one, "springs")
    found = hand_calculation.pinned(one, run)
    assert not isinstance(found, str) and "rear button" in found.words
    assert found.rate_rad_s[1] == pytest.approx(run.outcome.exit_rate[1], rel=0.08)
    assert run.by_hand == (found,) and found.at == "exit"
    mass, arm = one.payload.mass, -run.guides[0].place_m[0]
    span = run.guides[0].leaves_s - run.guides[1].leaves_s
    falling = mass * 0.8547 * arm * span / (one.payload.inertia.yy + mass * arm**2)
    assert abs(falling / run.outcome.exit_rate[1] - 1.0) > 0.2


@pytest.mark.parametrize("inner, valid", [("6.9 mm", True), ("6.36 mm", False)])
def test_a_lug_is_a_pin_while_it_has_play(inner, valid):
    """Two ends, 30 mm apart, that turn by 3e-3 rad; it bounces within its play. Control: with 5 um of play they
    hold the rocket, whose rate is a tenth of that of the pin."""
    rear, front = test_lugs.TABLES["lugs"]
    tables = test_lugs.TABLES | {"lugs": [rear | {"inner_diameter": inner}, front]}
    tilted = {"thrust_offset.misalignment": {"axial": "1 deg", "radial": "270 deg"}}
    start = {} if not valid else {"initial.position.z": "-0.275 mm"}  # on the rod, as it lies
    one = parse(tables).replace(test_lugs.STIFF | tilted | start)
    run = lowfi.run(one, "springs")
    found = hand_calculation.pinned(one, run)
    assert isinstance(found, str) is not valid
    if valid:
        assert "its rear lug" in found.words
        assert found.rate_rad_s[1] == pytest.approx(run.outcome.exit_rate[1], rel=0.15)
    else:
        assert "both its ends" in found and abs(np.degrees(run.outcome.exit_rate[1])) < 0.6


def test_what_is_not_valid_has_a_reason():
    rocket, tiny = load("rocket_rail"), load("tiny").condition("phi15")
    run = lowfi.run(tiny, "springs")
    assert "two buttons" in hand_calculation.pinned(tiny, run)
    touched = flight(pad_force=np.ones((601, 16, 3)))
    assert hand_calculation.rates(load("tiny"), touched) is None
    assert "8 pads touch" in hand_calculation.why_not(load("tiny"), touched)
    assert hand_calculation.why_not(load("tiny"), flight()) == ""
    free = rocket.replace({"contact": None, "friction": None})
    assert "nothing holds" in hand_calculation.pinned(free, lowfi.run(free))
    short = rocket.replace({"duration": "0.1 s"})
    assert "stays on the rail" in hand_calculation.pinned(short, lowfi.run(short, "springs"))
