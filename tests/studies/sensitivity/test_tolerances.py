"""Uncertain inputs that apply to a scene."""

import pytest

from tipoff import scenes
from tipoff.studies.sensitivity import tolerances


@pytest.mark.parametrize("name", ["cubesat_3u", "rocket_rail"])
def test_the_default_inputs_suit_every_launcher(name):
    """A law of thrust without the key ``peak`` has a function of this name. Control: a pulse."""
    found = tolerances.load(tolerances.DEFAULT, scenes.load(name))
    assert "thrust.peak" in found.left_out
    assert all(item.nominal is None or isinstance(item.nominal, float) for item in found.inputs)
    pulse = tolerances.load(tolerances.DEFAULT, scenes.load("reference"))
    assert "thrust.peak" in {item.key for item in pulse.inputs}
