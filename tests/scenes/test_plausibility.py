"""Values that pass and yet look like a slip of units are named, on both sides of each bound."""

import pytest

from scenes import parse
from tests.scenes.support import small

DENSITY = 2810.0


@pytest.mark.parametrize("speed, warned", [(99.0, True), (101.0, False), (9_990.0, False), (10_010.0, True)])
def test_wave_speed(speed, warned):
    scene = parse(small(rail__material__youngs_modulus=f"{DENSITY * speed**2!r} Pa"))
    assert len(scene.warnings) == warned
    assert all("rail.material.youngs_modulus" in text and "rail.material.density" in text for text in scene.warnings)


@pytest.mark.parametrize("mass, warned", [(0.9, False), (0.07, True), (0.09, False), (159.0, False), (161.0, True)])
def test_payload_density(mass, warned):
    scene = parse(small(payload__mass=f"{mass} kg", payload__size=["0.2 m", "0.2 m", "0.2 m"]))
    assert len(scene.warnings) == warned
    assert all("payload.mass" in text and "payload.size" in text for text in scene.warnings)


def test_slips_of_units_are_seen():
    """72 MPa for GPa, and 2.81 kg/m3 for g/cm3: both leave a valid scene."""
    assert parse(small(rail__material__youngs_modulus="0.72 MPa")).warnings
    assert parse(small(rail__material__density="2.81 kg/m**3")).warnings


def test_without_a_size_there_is_nothing_to_say():
    assert parse(small(payload__mass="1e6 kg")).warnings == []
