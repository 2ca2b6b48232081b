"""When a payload leaves the stop behind it, against the thrust in closed form."""

import math

import pytest

from tipoff.mechanics.estimates import stop
from tipoff.scenes import launch, load, scene_model
from tipoff.scenes.effects import hold_down

MASS, G = 10.0, 9.81
# 98.1 N along the rail
UPRIGHT = load("tiny").replace(
    {
        "platform": None,
        "gravity": {"x": -G},
        "payload.mass": MASS,
        "thrust_offset": None,
        "duration": None,
    }
)


def curve(tmp_path, *points):
    """The scene under a thrust through ``points`` of milliseconds and newtons."""
    path = tmp_path / "firing.csv"
    path.write_text("time_s,force_N\n" + "".join(f"{1e-3 * t},{f}\n" for t, f in points))
    return UPRIGHT.replace({"thrust": {"kind": "measured", "file": str(path)}})


@pytest.mark.parametrize("tilt", [0.0, 0.2])
def test_a_ramp_lifts_the_payload_at_its_weight(tmp_path, tilt):
    scene = curve(tmp_path, (0, 0), (20, 0), (30, 1000), (500, 1000))
    scene = scene.replace({"thrust_offset.misalignment.axial": tilt})
    exact = 0.02 + 0.01 * MASS * G / (1000.0 * math.cos(tilt))
    assert stop.is_there(launch.of_scene(scene)) and stop.release_time(
        launch.of_scene(scene)
    ) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("force, leaves", [(600.0, False), (4000.0, True)])
def test_the_spike_of_an_igniter_is_a_hop(tmp_path, force, leaves):
    """0.5 ms of 600 N lift 10 kg by 0.04 mm; 4 kN lift them by 2 mm, and the payload has left its stop
    before the motor burns."""
    spike = (0, 0), (2, 0), (2, force), (2.5, force), (2.5, 0)
    scene = curve(tmp_path, *spike, (100, 0), (101, 1000), (500, 1000))
    speed = (force / MASS - G) * 5e-4
    assert (0.25e-3 * speed + speed**2 / (2.0 * G) > stop.HOP) == leaves
    exact = 2e-3 if leaves else 0.1 + 1e-3 * MASS * G / 1000.0
    assert stop.release_time(launch.of_scene(scene)) == pytest.approx(exact, rel=1e-9)


def test_a_pulse_lifts_the_payload_at_its_weight():
    pulse = UPRIGHT.thrust
    exact = pulse.centre - pulse.width * math.sqrt(2.0 * math.log(pulse.peak / (MASS * G)))
    assert stop.release_time(launch.of_scene(UPRIGHT)) == pytest.approx(max(exact, 0.0), rel=1e-9)
    heavy = UPRIGHT.replace({"gravity.x": -100.0 * G})
    later = pulse.centre - pulse.width * math.sqrt(2.0 * math.log(pulse.peak / (100.0 * MASS * G)))
    assert later > 0.0 and stop.release_time(launch.of_scene(heavy)) == pytest.approx(
        later, rel=1e-9
    )
    weak = UPRIGHT.replace({"thrust.peak": 90.0})
    assert stop.release_time(launch.of_scene(weak)) == math.inf


@pytest.mark.parametrize("preload, released", [(97.0, math.inf), (99.0, 0.0)])
def test_springs_lift_the_payload_at_ignition_or_never(preload, released):
    spring = {"kind": "spring", "preload": preload, "rate": 100.0, "stroke": 0.01}
    assert stop.release_time(launch.of_scene(UPRIGHT.replace({"thrust": spring}))) == released


def test_a_latch_below_the_weight_leaves_the_payload_to_its_stop(tmp_path):
    """And one above it holds on. At zero it takes the stop away."""
    scene = curve(tmp_path, (0, 0), (20, 0), (30, 1000), (500, 1000))
    for release, held in ((50.0, MASS * G), (400.0, 400.0)):
        latched = scene.replace({"hold_down.release": release})
        assert hold_down.release_time(latched) == pytest.approx(0.02 + 1e-5 * release, rel=1e-12)
        assert stop.release_time(launch.of_scene(latched)) == pytest.approx(
            0.02 + 1e-5 * held, rel=1e-12
        )
        assert scene_model.build(latched).hold_down.is_stop == (held > release)
    assert scene_model.build(scene.replace({"hold_down.release": 0.0})).hold_down is None


@pytest.mark.parametrize(
    "change",
    [
        {"gravity": {"x": G}},
        {"gravity": {"z": -G}},
        {"gravity": None},
        {"platform": load("tiny").resolved()["platform"]},
        {"initial": {"velocity": {"x": 0.1}}},
        {"hold_down.release": 0.0},
    ],
)
def test_scenes_without_a_stop(change):
    scene = UPRIGHT.replace({"thrust.peak": 1.0} | change)
    assert not stop.is_there(launch.of_scene(scene)) and scene_model.build(scene).hold_down is None
    assert stop.is_there(launch.of_scene(UPRIGHT))
