"""When a run ends: bounds and estimates against motion in closed form."""

import math

import pytest

from tests.scenes.support import small
from tipoff.mechanics.estimates import ends
from tipoff.results import unfinished
from tipoff.scenes import SceneError, launch, load, parse

TINY = load("tiny").replace({"duration": None})
PUSH = {"kind": "constant", "force": 100.0, "duration": 0.02}
# one body on fixed rails: x'' = F / m
ALONE = TINY.replace({"platform": None, "contact": None, "friction": None, "payload.mass": 10.0})


def test_a_stated_duration_is_the_limit_and_keeps_the_hash():
    scene = load("tiny")
    assert scene.time_limit == scene.expected_end == scene.duration == 0.025
    assert TINY.duration is None and TINY.hash != scene.hash
    assert "duration" not in TINY.resolved()
    assert parse(TINY.resolved(), bare_numbers_are_si=True).hash == TINY.hash


@pytest.mark.parametrize("mass", [1.0, 10.0, 40.0])
def test_a_payload_at_the_jam_speed_leaves_within_the_limit(mass):
    """After the thrust it needs way / 10 mm/s; variations that are slower share the limit."""
    scene = TINY.replace({"payload.mass": mass})
    slowest = 4.5e-3 + launch.of_scene(scene).way / 0.01
    assert slowest < scene.time_limit < 2.0 * slowest + 0.1
    assert scene.time_limit == TINY.time_limit == 32.768


def test_the_limit_follows_what_varies():
    late = TINY.replace({"thrust.centre": 40.0})
    assert (
        40.0 + launch.of_scene(late).way / 0.01 < late.time_limit <= 64.0 + 36.0
    )  # 1e6 samples of 0.1 ms
    assert (
        TINY.replace({"friction.static_speed": 0.3, "friction.dynamic_speed": 0.6}).time_limit < 2
    )


def test_a_payload_that_falls_back_ends_its_run_early():
    """It rises until v / g; control: without gravity the limit is that of a slow payload."""
    weak = ALONE.replace({"thrust": PUSH})
    falling = weak.replace({"gravity": {"x": -9.81}})
    top = 100.0 * 0.02 / 10.0 / 9.81
    assert 0.02 + top < falling.time_limit < 0.2 < weak.time_limit


def test_the_expected_end_is_that_of_the_pulse_alone():
    """A payload far slower than its pulse coasts at impulse / mass."""
    pulse = {"kind": "gaussian", "peak": 100.0, "width": 0.004, "centre": 0.012}
    scene = ALONE.replace({"thrust": pulse})
    # the pulse begins three widths before its peak
    impulse = 100.0 * 0.004 * math.sqrt(math.pi / 2.0) * (1.0 + math.erf(3.0 / math.sqrt(2.0)))
    cut = 100.0 * 0.004**2 * math.exp(-4.5)  # its mean instant is later than the peak
    coasting = launch.of_scene(scene).way / (impulse / 10.0) + cut / impulse
    assert scene.expected_end == pytest.approx(1.25 * (coasting + 0.012 + 0.003), rel=1e-5)


def test_the_expected_end_is_that_of_the_curve_alone(tmp_path):
    """A constant push of 20 ms, then a pull back of 10 ms, then the exit by coasting: in three
    pieces with a closed form."""
    path = tmp_path / "firing.csv"
    path.write_text("time_s,force_N\n0,100\n0.02,100\n0.02,-50\n0.03,-50\n")
    scene = ALONE.replace({"thrust": {"kind": "measured", "file": str(path)}})
    speed = 100.0 * 0.02 / 10.0
    way = 0.5 * speed * 0.02 + speed * 0.01 - 0.5 * 5.0 * 0.01**2
    exits = 0.03 + (launch.of_scene(scene).way - way) / (speed - 5.0 * 0.01)
    assert scene.expected_end == pytest.approx(1.25 * (exits + 0.003), rel=1e-6)
    # from 1 mm before the end it leaves before it is pulled back: the thrust ends last
    begun = scene.replace({"initial.position.x": launch.of_scene(scene).way - 1e-3})
    assert begun.expected_end == pytest.approx(1.25 * (0.03 + 0.002), rel=1e-6)


@pytest.mark.parametrize("share, refused", [(0.999, True), (1.001, False)])
def test_a_duration_that_is_too_short_without_friction_is_foreseen(share, refused):
    """The exit under a constant push, x = F t^2 / 2 m, on both sides."""
    scene = ALONE.replace({"thrust": PUSH | {"force": 2000.0, "duration": 0.04}})
    exits = math.sqrt(2.0 * launch.of_scene(scene).way * 10.0 / 2000.0)
    assert exits + 1e-3 > 0.04  # it leaves after the thrust, or nearly
    needed = exits + 3e-3 if exits <= 0.04 else None
    if needed is None:
        at_end = 2000.0 * 0.04**2 / 20.0
        needed = 0.04 + (launch.of_scene(scene).way - at_end) / (2000.0 * 0.04 / 10.0) + 3e-3
    stated = scene.replace({"duration": share * needed})
    words = unfinished.foreseen(stated)
    assert bool(words) == refused
    assert not refused or ("at least" in words and "without duration" in words)


def test_nothing_is_foreseen_of_a_launch_in_time_and_of_none_stated():
    for name in ("tiny", "reference"):
        scene = load(name)
        assert all(unfinished.foreseen(scene.condition(own)) == "" for own in scene.conditions)
    assert unfinished.foreseen(TINY.replace({"thrust.peak": 1.0})) == ""
    still = load("tiny").replace({"thrust.peak": 0.0, "thrust.width": "1 ms"})
    assert "does not leave" in unfinished.foreseen(still)


@pytest.mark.parametrize("interval, refused", [("0.1 ms", True), ("10 ms", False)])
def test_a_thrust_that_outlasts_every_run_is_refused(interval, refused):
    raw = small(
        thrust={"kind": "constant", "force": "5 N", "duration": "200 s"},
        output={"interval": interval},
    )
    del raw["duration"]
    if not refused:
        assert parse(raw).time_limit >= 200.0
        return
    with pytest.raises(SceneError) as caught:
        parse(raw)
    (fault,) = caught.value.faults
    assert fault.key == "output.interval" and "a duration" in fault.expected
    short = parse(raw | {"thrust": raw["thrust"] | {"duration": "1 s"}})
    with pytest.raises(SceneError, match="output.interval"):
        short.replace({"thrust.duration": 200.0})


@pytest.mark.parametrize(
    "change, speed",
    [
        # held by friction: it would be faster than 10 mm/s without
        ({}, 0.01),
        ({"initial": {"velocity": {"x": 0.02}}, "thrust.peak": 0.0, "thrust.width": "1 ms"}, 0.01),
        ({"gravity": {"x": 1e-3}, "platform": None, "thrust.peak": 1.0}, 0.01),
        ({"gravity": {"x": -1.0, "z": -6.0}, "platform": None}, 0.01),
        # it coasts, or only its weight moves it
        ({"thrust.peak": 5.0}, 0.224 / 3600.0),
        ({"friction": None}, 0.224 / 3600.0),
        ({"friction": None, "gravity": {"x": -1.0}, "platform": None}, 0.0),
        ({"gravity": {"x": -1.0, "z": -4.0}, "platform": None}, 0.224 / 3600.0),
    ],
)
def test_the_speed_below_which_a_payload_is_jammed(change, speed):
    """Friction of 0.2 holds a payload on a slope of less than atan(0.2)."""
    assert ends.jam_speed(launch.of_scene(load("tiny").replace(change))) == pytest.approx(
        speed, rel=1e-12
    )


def test_the_limit_of_a_payload_that_is_slow_without_friction():
    """From rest under its weight it takes sqrt(2 way / g), after a gentle push way / v. Control: the limit
    of a fast one, at which both are still on the rail."""
    free = ALONE.replace({"output.interval": "1 ms"})
    push = {"kind": "constant", "force": 0.5, "duration": 0.1}
    for change, exits in (
        ({"thrust": PUSH | {"force": 0.0}, "gravity": {"x": 1e-4}}, math.sqrt(2.0 * 0.224 / 1e-4)),
        ({"thrust": push}, 0.1 + 0.224 / (0.05 / 10.0) - 0.05),
    ):
        assert exits < free.replace(change).time_limit < 2.0 * (exits + 0.1)
        assert exits > free.time_limit
