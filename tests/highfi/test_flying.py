"""A velocity that payload, rails and platform share changes nothing."""

import numpy as np
import pytest

from tests.highfi.support import COARSE, tiny, whole
from tipoff import highfi


@pytest.mark.case("O50")
@pytest.mark.parametrize(
    "velocity",
    [pytest.param((1000.0, 0.0, 0.0), marks=pytest.mark.slow), (4330.1, 3061.9, -5303.3)],
)
def test_a_uniform_velocity_changes_nothing(velocity):
    """To 1e-9, at 1 km/s along the axis and 7.5 km/s across all of them; the ledgers close as at
    rest."""
    shared = {
        f"initial__{body}velocity__{axis}": value
        for body in ("", "platform_")
        for axis, value in zip("xyz", velocity)
    }
    rest, flown = whole(), highfi.run(tiny(**shared), COARSE)
    assert flown.status == rest.status == "exited", flown.message
    assert flown.outcome.rate == pytest.approx(rest.outcome.rate, rel=1e-9)
    assert flown.outcome.exit_time == pytest.approx(rest.outcome.exit_time, rel=1e-9)
    assert (
        np.abs(np.subtract(flown.outcome.velocity, velocity) - rest.outcome.velocity).max() <= 1e-9
    )
    assert (
        np.abs(flown.position - np.multiply.outer(rest.time, velocity) - rest.position).max()
        <= 1e-9
    )
    assert flown.checks["transverse_energy_error"] == pytest.approx(
        rest.checks["transverse_energy_error"], rel=1e-3
    )
