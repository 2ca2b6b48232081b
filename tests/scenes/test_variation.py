"""Variations of a scene are the scenes that ``Scene.replace`` makes, in all that is derived of them."""

import pytest

from tipoff.scenes import load
from tipoff.scenes.variation import Variations

SCENE = load("tiny").condition("phi15")


@pytest.mark.parametrize(
    "rows",
    [
        [{"payload.mass": 10.0}, {"payload.mass": 11.0}, {"payload.mass": 12.0}],
        [{"contact.clearance": 3e-4, "gravity.z": -1.0}] * 2,
        [{"friction": "absent"}, {"thrust_offset.misalignment.axial": "0.3 deg"}],
        [{"pads.0.relief": 2e-5}, {"pads.0.relief": 3e-5}],
    ],
)
def test_a_variation_has_nothing_of_its_base(rows):
    """Its hash is its own, and what is replaced or asked for in it starts from its own values. Control:
    the hash of the base, which was known before."""
    base, variations = SCENE.hash, Variations(SCENE)
    for row in rows:
        found, expected = variations.of(row), SCENE.replace(row)
        assert found.hash == expected.hash != base and found.warnings == expected.warnings
        further = {"output.interval": 2e-4}
        assert found.replace(further).hash == expected.replace(further).hash
        assert found.condition("h1").hash == expected.condition("h1").hash
    assert SCENE.hash == base


def test_a_kept_variation_is_not_overwritten():
    """It shares the tables that no row changes. Control: the variation itself, which the next call
    overwrites."""
    variations = Variations(SCENE)
    rows = [{"payload.mass": mass} for mass in (10.0, 11.0, 12.0)]
    own, kept = zip(*((found, variations.kept(found)) for found in map(variations.of, rows)))
    assert own[1] is own[2] and own[1].payload.mass == 12.0
    for row, found in zip(rows, kept):
        assert found.hash == SCENE.replace(row).hash and found.payload.mass == row["payload.mass"]
        assert found.rail is SCENE.rail
