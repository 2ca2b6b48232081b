"""A hold-down on springs: the speed after its release against the integral of the thrust."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from tests.lowfi.support import CENTRED, PAPER_PAD, G, corners, scene
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.lowfi.ensemble.batch import Family
from tipoff.results import unfinished
from tipoff.scenes import launch, load
from tipoff.scenes.effects.hold_down import release_time

MASS, PEAK, WIDTH, CENTRE = 20.0, 4000.0, 2e-3, 6e-3
PULSE = {"kind": "gaussian", "peak": PEAK, "width": WIDTH, "centre": CENTRE}
PLATFORM = {"mass": 50.0, "inertia": {"xx": 2.0, "yy": 2.0, "zz": 2.0}}
OPEN = {"contact": PAPER_PAD, "pads": corners(), "thrust": PULSE}
TINY = load("tiny")


def pulse(time: float) -> float:
    return PEAK * np.exp(-0.5 * ((time - CENTRE) / WIDTH) ** 2)


def released(level: float) -> float:
    """Time (s) at which the pulse rises to a level (N), by its logarithm."""
    return CENTRE - WIDTH * np.sqrt(2.0 * np.log(PEAK / level))


def held(level: float, **tables):
    return scene(0.014, 1e-4, mass=MASS, **OPEN | {"hold_down": {"release": level}} | tables)


@pytest.mark.case("O91")
@pytest.mark.parametrize("level", [1000.0, 3999.0])
def test_the_speed_is_the_impulse_after_the_release(level):
    asked = held(level, platform=PLATFORM, thrust_offset=CENTRED)
    run, at = lowfi.run(asked, "springs"), released(level)
    assert release_time(asked) == pytest.approx(at, rel=1e-12)
    speed = run.to_xarray().relative_velocity.values[:, 0]
    before = run.time < at
    assert before.sum() > 3 and np.abs(speed[before]).max() < 1e-12
    gain = 1.0 / MASS + 1.0 / PLATFORM["mass"]
    impulse = quad(pulse, at, run.time[-1], points=[CENTRE], epsabs=1e-12)[0]
    assert speed[-1] == pytest.approx(gain * impulse, rel=1e-7)
    assert run.checks["linear_momentum_error"] < 1e-12
    # Control: without a hold-down the payload has the whole impulse.
    free = lowfi.run(asked.replace({"hold_down": None}), "springs")
    assert free.to_xarray().relative_velocity.values[-1, 0] > 1.02 * speed[-1]


def test_the_platform_takes_the_reaction_of_a_thrust_that_leaves():
    """The thrust of a rocket pushes platform and payload together until the release."""
    asked = held(1000.0, platform=PLATFORM, thrust=PULSE | {"reaction": "exhaust"})
    run, at = lowfi.run(asked, "springs"), released(1000.0)
    last = np.flatnonzero(run.time < at)[-1]
    impulse = quad(pulse, 0.0, run.time[last])[0]
    together = impulse / (MASS + PLATFORM["mass"])
    assert run.velocity[last, 0] == pytest.approx(together, rel=1e-7)
    assert run.platform_velocity[-1, 0] == pytest.approx(
        quad(pulse, 0.0, at)[0] / (MASS + PLATFORM["mass"]), rel=1e-7
    )


def test_the_line_of_the_latch_has_no_speed_along_the_rail():
    """A platform whose mass centre is off the rail turns under the thrust, and the payload with it: the
    payload's point on the line, beside its mass centre, keeps its distance along the rail. Control:
    its point on a line through the platform's mass centre does not."""
    centre = {"x": 0.0, "y": 0.12, "z": -0.2}
    platform = PLATFORM | {"mass_centre": centre}
    outward, turning = PULSE | {"reaction": "exhaust"}, {"rate": {"x": 3.0, "y": 0.0, "z": 0.0}}
    asked = held(3999.0, platform=platform, thrust=outward, initial=turning)
    run = lowfi.run(asked, "springs")
    before = np.flatnonzero(run.time < released(3999.0))
    base, body = (
        Rotation.from_quat(turn[before], scalar_first=True)
        for turn in (run.platform_quaternion, run.quaternion)
    )
    spins = base.apply(run.platform_rate[before]), body.apply(run.rate[before])
    apart = run.position[before] - run.platform_position[before]
    seen = base.inv().apply(apart)
    line = np.column_stack([seen[:, 0], np.full((before.size, 2), [-centre["y"], -centre["z"]])])
    arm = base.apply(line)
    speed = run.velocity[before] + np.cross(spins[1], arm - apart)
    speed -= run.platform_velocity[before] + np.cross(spins[0], arm)
    along = base.inv().apply(speed)[:, 0]
    assert np.abs(spins[0]).max(axis=0).min() > 0.2 and np.abs(along).max() < 1e-7
    away = base.apply(np.column_stack([np.zeros(before.size), -line[:, 1:]]))
    other = speed + np.cross(spins[1] - spins[0], away)
    assert np.abs(base.inv().apply(other)[:, 0]).max() > 1e-3


@pytest.mark.case("O91")
@pytest.mark.parametrize("gravity", [0.0, -G])
def test_a_release_at_a_time_is_a_thrust_that_begins_then(gravity):
    """A steady thrust from ignition on, and a latch until t_0: the payload does not move before, and then as
    under a thrust that begins at t_0. Control: without the latch it moves at once."""
    at, tables = 5e-3, {"gravity": {"x": gravity, "y": 0.0, "z": 0.0}}
    push = {"kind": "constant", "force": 1000.0, "start": 0.0, "duration": 0.1}
    asked = held(0.0, thrust=push, **tables)
    asked = asked.replace({"hold_down": {"release_time": at}})
    shifted = held(500.0, thrust=push | {"start": at}, **tables)
    run, other = (lowfi.run(each, "springs") for each in (asked, shifted))
    before = run.time < at
    assert before.sum() > 3 and np.abs(run.velocity[before]).max() < 1e-12
    assert np.abs(run.position[before] - run.position[0]).max() < 1e-14
    for name in ("position", "velocity", "rate"):
        np.testing.assert_allclose(getattr(run, name), getattr(other, name), atol=1e-10)
    speed = (1000.0 / MASS + gravity) * (run.time[-1] - at)
    assert run.velocity[-1, 0] == pytest.approx(speed, rel=1e-9)
    free = lowfi.run(asked.replace({"hold_down": {"release_time": 0.0}}), "springs")
    assert free.velocity[before][-1, 0] > 0.1


def test_a_release_by_thrust_and_at_its_time_are_one():
    """Control: another time gives another motion."""
    at = released(1000.0)
    by_thrust = lowfi.run(held(1000.0), "springs")
    for time, same in ((release_time(held(1000.0)), True), (at + 1e-3, False)):
        run = lowfi.run(held(0.0).replace({"hold_down": {"release_time": time}}), "springs")
        assert (run.velocity.tobytes() == by_thrust.velocity.tobytes()) is same


def test_a_payload_on_an_upright_rail_does_not_fall():
    """Gravity pulls it back before the release. Control: with a release at ignition it falls."""
    late = {"kind": "constant", "force": 1000.0, "start": 5e-3, "duration": 0.1}
    tables = {"thrust": late, "gravity": {"x": -G, "y": 0.0, "z": 0.0}}
    run = lowfi.run(held(500.0, **tables), "springs")
    before = run.time < 5e-3
    assert np.abs(run.velocity[before]).max() < 1e-12
    expected = (1000.0 / MASS - G) * (run.time[-1] - 5e-3)
    assert run.velocity[-1, 0] == pytest.approx(expected, rel=1e-9)
    free = lowfi.run(held(0.0, **tables), "springs")
    assert free.velocity[before][-1, 0] < -0.04


LATE = {"kind": "constant", "force": 1000.0, "start": 0.1, "duration": 1.0}
TUBE = {
    "start": -1.0,
    "end": 0.5,
    "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
}


def on_slope(angle: float, **tables):
    """At rest on a rail at an ``angle`` (rad) to the ground, untouched by it."""
    weight = {"x": -G * np.sin(angle), "y": 0.0, "z": 0.0}
    return scene(
        0.5, 1e-3, mass=MASS, rail=TUBE, **OPEN | {"thrust": LATE, "gravity": weight} | tables
    )


@pytest.mark.parametrize("angle", [np.pi / 2.0, 0.5])
def test_a_rocket_rests_on_its_stop_until_its_motor_burns(angle):
    """From rest its speed at the end of the rail is sqrt(2 a s). Control: without latch and stop it falls
    until then, by d = g t^2 / 2, and has the speed sqrt((g t)^2 + 2 a (s + d))."""
    asked = on_slope(angle)
    pull, way, start = G * np.sin(angle), launch.of_scene(asked).way, LATE["start"]
    push = LATE["force"] / MASS - pull
    run = lowfi.run(asked, "springs")
    assert np.abs(run.velocity[run.time < start]).max() < 1e-12
    speed = np.sqrt(2.0 * push * way)
    # mean over 0.2 ms, in which the thrust acts on
    assert run.outcome.exit_velocity[0] == pytest.approx(speed + 1e-4 * push, rel=1e-9)
    assert run.outcome.exit_time == pytest.approx(start + np.sqrt(2.0 * way / push), rel=1e-9)
    assert run.checks["energy_error"] < 1e-9 and run.checks["linear_momentum_error"] < 1e-12
    free = lowfi.run(asked.replace({"hold_down.release": 0.0}), "springs")
    fast = np.sqrt((pull * start) ** 2 + 2.0 * push * (way + 0.5 * pull * start**2))
    assert free.outcome.exit_velocity[0] == pytest.approx(fast + 1e-4 * push, rel=1e-9)


def test_a_thrust_that_grows_lifts_the_payload_without_a_jump(tmp_path):
    """Under c (t - t_0) the speed is (c / m) (t - t_1)^2 / 2 after the thrust has reached the weight at t_1.
    The cases of an ensemble have releases of their own, in one call of the kernel."""
    path, slope = tmp_path / "ramp.csv", 1e4
    path.write_text(f"time_s,force_N\n0,0\n0.01,0\n0.06,{0.05 * slope}\n")
    asked = on_slope(np.pi / 2.0, thrust={"kind": "measured", "file": str(path)})
    asked = asked.replace({"duration": 0.055})
    run, lifted = lowfi.run(asked, "springs"), 0.01 + MASS * G / slope
    after = run.time > lifted
    assert np.abs(run.velocity[~after]).max() < 1e-12
    exact = 0.5 * slope / MASS * (run.time[after] - lifted) ** 2
    assert run.velocity[after, 0] == pytest.approx(exact, abs=1e-6 * exact[-1])
    rows = [{"payload.mass": mass} for mass in (20.0, 25.0, 40.0)]
    family = Family(asked, None, Numerics(modes=0))
    assert len(family.jobs(rows)) == 1
    found = lowfi.run_many(asked, rows, "springs")
    steps = [lowfi.run(asked.replace(row), "springs").cost["steps"] for row in rows]
    assert found.steps.values.tolist() == steps and len(set(steps)) > 1


@pytest.mark.parametrize(
    "force, words", [(190.0, "rests on its stop"), (400.0, "fell back on its stop")]
)
def test_a_payload_that_its_thrust_does_not_carry_ends_on_its_stop(force, words):
    """A weight of 196 N. Control: without latch and stop it falls on, and is not said to be on the rail."""
    short = {"kind": "constant", "force": force, "start": 0.0, "duration": 0.05}
    asked = on_slope(np.pi / 2.0, thrust=short)
    run = lowfi.run(asked, "springs")
    assert run.status == "jammed" and words in unfinished.advice(asked, run)
    speed = (force / MASS - G) * 0.05
    if speed > 0.0:
        top = 0.5 * speed * 0.05 + speed**2 / (2.0 * G)
        back = 0.05 + (speed + np.sqrt(2.0 * G * (top + 1e-3))) / G
        # to a millisecond, a piece of a step, and another one until the run ends
        assert back <= run.time[-1] < back + 3e-3
    free = asked.replace({"hold_down.release": 0.0})
    text = unfinished.advice(free, lowfi.run(free, "springs"))
    assert text.startswith("slid back along the rail") and "no stop or latch" in text


def test_a_payload_without_a_stop_falls_off_the_rear_end():
    """Its thrust would carry it back through the rail. Control: a thrust that turns it on the rail."""
    fallen, caught = (
        on_slope(0.5 * np.pi, hold_down={"release": 0.0}, thrust=LATE | {"start": start})
        for start in (1.0, 0.1)
    )
    run = lowfi.run(fallen, "springs")
    front = max(pad.position[0] + 0.5 * pad.length for pad in fallen.pads)
    exact = np.sqrt(2.0 * (front - TUBE["start"]) / G)
    assert run.status == "jammed" and run.time[-1] == pytest.approx(exact, abs=6e-3)
    assert "fell off the rear end of the rail" in unfinished.advice(fallen, run)
    assert lowfi.run(caught, "springs").outcome.exit_time is not None


@pytest.mark.case("O91")
@pytest.mark.parametrize("level", [0.0, 20.0])
def test_a_release_at_ignition_has_the_same_bits_as_none(level):
    """The pulse begins with 44 N."""
    assert pulse(0.0) > 20.0
    free = lowfi.run(scene(0.014, 1e-4, mass=MASS, **OPEN), "springs")
    run = lowfi.run(held(level), "springs")
    for name in ("position", "velocity", "quaternion", "rate", "pad_force", "energy"):
        assert getattr(run, name).tobytes() == getattr(free, name).tobytes()


def test_scenes_without_the_table_keep_their_hash():
    assert "hold_down" in TINY.absent_effects() and "hold_down" not in TINY.resolved()
    other = TINY.replace({"hold_down.release": "2 kN"})
    assert other.hash != TINY.hash and other.replace({"hold_down": None}).hash == TINY.hash


def test_a_curve_that_jumps_releases_at_the_jump():
    late = {"kind": "constant", "force": 100.0, "start": 2e-3, "duration": 1e-3}
    assert release_time(held(100.0, thrust=late)) == 2e-3
    assert release_time(held(0.0, thrust=late)) == 0.0


def test_cases_are_held_too():
    asked = held(1000.0, platform=PLATFORM)
    rows = [{"payload.mass": 20.0}, {"payload.mass": 30.0, "hold_down.release": 2000.0}]
    found = lowfi.run_many(asked, rows, "springs")
    steps = [lowfi.run(asked.replace(row), "springs").cost["steps"] for row in rows]
    assert found.steps.values.tolist() == steps
