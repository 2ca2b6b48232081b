"""A hold-down on flexible rails: the speed at the exit against the integral of the thrust."""

import numpy as np
import pytest
from scipy.integrate import quad

from tests.highfi.support import COARSE, tiny
from tipoff import highfi
from tipoff.mechanics.laws.thrust import sample
from tipoff.mechanics.run_limits import EXIT_WINDOW
from tipoff.results import unfinished
from tipoff.scenes import launch
from tipoff.scenes.effects.hold_down import release_time


@pytest.mark.case("O91")
@pytest.mark.slow
@pytest.mark.parametrize("by_time", [False, True])
@pytest.mark.parametrize("platform", [True, False])
def test_the_speed_at_the_exit_is_the_impulse_after_the_release(platform, by_time):
    """Within the impulse of a step. Control: without a hold-down the payload is faster."""
    absent = {"friction": None, "thrust_offset": None} | ({} if platform else {"platform": None})
    asked = tiny(**absent, hold_down={"release": 2000.0})
    at = release_time(asked)
    if by_time:
        asked = asked.replace({"hold_down": {"release_time": at}})
    run = highfi.run(asked, COARSE)
    law, mass = asked.thrust.record(), asked.payload.mass
    assert sample(law, np.array([at]))[0] == pytest.approx(2000.0, rel=1e-12)
    speed = run.to_xarray().relative_velocity.values[:, 0]
    assert np.abs(speed[run.time < at]).max() < 1e-12
    gain = 1.0 / mass + (1.0 / asked.platform.mass if platform else 0.0)
    middle = run.outcome.exit_time + 0.5 * EXIT_WINDOW
    impulse = quad(lambda time: sample(law, np.array([time]))[0], at, middle, epsabs=1e-10)[0]
    found = run.outcome.exit_velocity[0]
    found -= run.outcome.exit_platform_velocity[0] if platform else 0.0
    assert abs(found - gain * impulse) < gain * 2000.0 * run.cost["dt_s"]
    free = highfi.run(asked.replace({"hold_down": None}), COARSE)
    assert free.outcome.exit_velocity[0] > run.outcome.exit_velocity[0] + 0.05


@pytest.mark.slow
@pytest.mark.parametrize("angle", [np.pi / 2.0, 0.5])
def test_a_rocket_rests_on_its_stop_until_its_motor_burns(angle):
    """As ``tests.lowfi.dynamics.test_hold_down``: sqrt(2 a s) from rest, within the impulse of a step.
    Control: without latch and stop it falls until then."""
    late = {"kind": "constant", "force": 9e3, "start": 5e-3, "duration": 0.1}
    absent = {"friction": None, "thrust_offset": None, "platform": None, "duration": None}
    asked = tiny(**absent, thrust=late, gravity={"x": -9.81 * np.sin(angle)})
    run, pull, way = highfi.run(asked, COARSE), 9.81 * np.sin(angle), launch.of_scene(asked).way
    assert np.abs(run.velocity[run.time < late["start"]]).max() < 1e-12
    push = late["force"] / asked.payload.mass - pull
    error = push * run.cost["dt_s"]
    speed = np.sqrt(2.0 * push * way) + 0.5 * EXIT_WINDOW * push
    assert run.outcome.exit_velocity[0] == pytest.approx(speed, abs=error)
    assert run.checks["energy_error"] < 1e-5 and run.checks["linear_momentum_error"] < 1e-12
    free = highfi.run(asked.replace({"hold_down.release": 0.0}), COARSE)
    fallen = 0.5 * pull * late["start"] ** 2
    fast = np.sqrt((pull * late["start"]) ** 2 + 2.0 * push * (way + fallen))
    assert free.outcome.exit_time < run.outcome.exit_time + 1e-3
    assert free.outcome.exit_velocity[0] == pytest.approx(
        fast + 0.5 * EXIT_WINDOW * push, abs=error
    )
    assert free.velocity[run.time < late["start"]][-1, 0] < -0.9 * pull * late["start"]


@pytest.mark.slow
def test_a_payload_that_its_thrust_does_not_carry_ends_on_its_stop():
    """Thrown up by v it is back after 2 v / g, and 1 mm lower a little later."""
    short = {"kind": "constant", "force": 1e3, "start": 0.0, "duration": 1e-3}
    absent = {"friction": None, "thrust_offset": None, "platform": None, "duration": None}
    asked = tiny(**absent, thrust=short, gravity={"x": -9.81})
    run = highfi.run(asked, COARSE)
    assert run.status == "jammed" and "fell back on its stop" in unfinished.advice(asked, run)
    speed = (1e3 / asked.payload.mass - 9.81) * 1e-3
    top = 0.5e-3 * speed + speed**2 / (2.0 * 9.81)
    back = 1e-3 + (speed + np.sqrt(2.0 * 9.81 * (top + 1e-3))) / 9.81
    assert back - 1e-4 <= run.time[-1] < back + 2e-3


@pytest.mark.slow
def test_a_release_at_ignition_has_the_same_bits_as_none():
    free = highfi.run(tiny(), COARSE)
    run = highfi.run(tiny(hold_down={"release": 0.0}), COARSE)
    for name in ("position", "velocity", "quaternion", "rate", "pad_force", "energy"):
        assert getattr(run, name).tobytes() == getattr(free, name).tobytes()
