"""The table of a flight: common orbits, and that no ejection depends on it."""

import math

import pytest

from tipoff.scenes import load

SCENE = load("reference")


def test_no_ejection_depends_on_a_flight():
    assert SCENE.flight is not None
    other = SCENE.replace({"flight.range": "3 km", "flight.roll": "9 deg"})
    assert SCENE.hash == SCENE.replace({"flight": None}).hash == other.hash
    assert "flight" not in SCENE.absent_effects() + SCENE.replace({"flight": None}).absent_effects()
    assert SCENE.hash != SCENE.replace({"payload.mass": "9.8 kg"}).hash  # control


@pytest.mark.parametrize(
    "altitude, period", [("35786 km", 86164.1), ("20182 km", 43077.0), ("400 km", 5553.6)]
)
def test_periods(altitude, period):
    """Geostationary, navigation satellites (half a sidereal day), a space station without the
    flattening of the Earth."""
    flight = SCENE.replace({"flight.altitude": altitude}).flight.record()
    assert 2.0 * math.pi / flight.mean_motion == pytest.approx(period, rel=1e-4)
    assert flight.duration == pytest.approx(2.0 * math.pi / flight.mean_motion)
    assert SCENE.replace({"flight.duration": "2 hour"}).flight.record().duration == 7200.0
