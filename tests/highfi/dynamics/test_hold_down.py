"""A hold-down on flexible rails: the speed at the exit against the integral of the thrust."""

import numpy as np
import pytest
from scipy.integrate import quad

from tests.highfi.support import COARSE, tiny
from tipoff import highfi
from tipoff.mechanics.outcome import EXIT_WINDOW
from tipoff.scenes.effects.hold_down import release_time
from tipoff.scenes.effects.thrust_law import sample


@pytest.mark.case("O91")
@pytest.mark.slow
@pytest.mark.parametrize("platform", [True, False])
def test_the_speed_at_the_exit_is_the_impulse_after_the_release(platform):
    """Within the impulse of a step. Control: without a hold-down the payload is faster."""
    absent = {"friction": None, "thrust_offset": None} | ({} if platform else {"platform": None})
    asked = tiny(**absent, hold_down={"release": 2000.0})
    run, at = highfi.run(asked, COARSE), release_time(asked)
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
def test_a_release_at_ignition_has_the_same_bits_as_none():
    free = highfi.run(tiny(), COARSE)
    run = highfi.run(tiny(hold_down={"release": 0.0}), COARSE)
    for name in ("position", "velocity", "quaternion", "rate", "pad_force", "energy"):
        assert getattr(run, name).tobytes() == getattr(free, name).tobytes()
