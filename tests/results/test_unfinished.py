"""What a run that ends too early is told: the duration that it states is enough, and a shorter one
is not. The runs are free of contact, so nothing but the thrust moves the payload."""

import re

import pytest

from tests.lowfi.support import CENTRED, IMMOVABLE, WEIGHTLESS
from tipoff import lowfi
from tipoff.mechanics.outcome import relative_motion
from tipoff.results import unfinished
from tipoff.scenes import launch, load

FREE = {"contact": None, "friction": None, "gravity": None}


@pytest.fixture(scope="module")
def scene():
    return load("tiny").replace(FREE)


def told(scene):
    return unfinished.advice(scene, lowfi.run(scene))


def stated(text):
    return re.search(r"duration of (\S+ ms)", text)[1]


def test_a_duration_that_ends_before_the_rates_settle(scene):
    whole = lowfi.run(scene)
    assert whole.status == "exited" and unfinished.advice(scene, whole) == ""
    text = told(scene.replace({"duration": whole.outcome.window_start + 1e-3}))
    enough = float(stated(text).split()[0])
    assert lowfi.run(scene.replace({"duration": stated(text)})).status == "exited"
    less = scene.replace({"duration": f"{enough - 0.02} ms"})
    assert lowfi.run(less).status == "time_limit"


def test_a_thrust_that_lasts_longer_than_the_rail_is_named(scene):
    long = scene.replace({"thrust.width": "6 ms", "thrust.centre": "18 ms", "thrust.peak": "9 kN"})
    text = told(long.replace({"duration": "38 ms"}))
    # exp(-x^2 / 2) = 0.001 at x = 3.717 widths
    assert text.startswith("thrust falls below 0.1 % of its peak at 40.3")
    assert stated(text).startswith("42.3")


def test_a_payload_on_the_rail_has_its_way_and_a_duration_that_is_enough(scene):
    exit_time = lowfi.run(scene).outcome.exit_time
    early = scene.replace({"duration": 0.9 * exit_time})
    text = told(early)
    assert text.startswith("still on the rail: ")
    assert f"of {1e3 * launch.of_scene(scene).way:.3g} mm" in text
    assert lowfi.run(scene.replace({"duration": stated(text)})).status == "exited"


def test_the_way_is_the_one_that_a_run_has_made_at_its_exit(scene):
    alone = {"thrust_offset": CENTRED, "platform": IMMOVABLE}
    fine = scene.replace({"output.interval": "1 us"} | alone)
    run = lowfi.run(fine)
    place = relative_motion(run)["relative_position"][:, 0]
    at_exit = place[abs(run.time - run.outcome.exit_time).argmin()]
    speed = run.outcome.velocity[0]
    assert at_exit - place[0] == pytest.approx(launch.of_scene(fine).way, abs=2e-6 * speed)


def test_thrust_without_an_end_and_a_payload_that_hardly_moves(scene):
    burning = {"kind": "constant", "force": "9 kN", "duration": "1 hour"}
    # the effects of one body, for which a kernel is compiled
    one_body = {"platform": None, "gravity": WEIGHTLESS}
    constant = scene.replace({"thrust": burning, "duration": "6 ms"} | one_body)
    assert "the thrust does not end" in told(constant)
    still = scene.replace({"thrust.peak": "1 mN", "duration": "3 ms"})
    assert "needs more thrust" in told(still) and "lasts until" in told(still)


@pytest.mark.parametrize("start", [0.0, -0.06])
def test_a_rail_that_begins_in_front_of_the_rear_pads_is_named_where_a_run_diverges(start):
    """The payload turns before its rear pads are at the rail. Control: a diverged run on a rail that
    begins behind all pads has another cause."""
    keys = {"rail.start": start, "rail.mounts": [], "initial.rate.z": 2.0}
    scene = load("tiny").replace(keys)
    run = lowfi.run(scene, "springs")
    assert run.status == "diverged" and "strikes the rear end" in run.message
    words = unfinished.advice(scene, run)
    assert words.startswith(f"the rail starts at X = {start:g} m, in front of pads 0, 1, 2, 3: ")
    assert words.endswith("start the rail at -0.088 m or behind that")
    assert unfinished.advice(load("tiny"), run) == ""
