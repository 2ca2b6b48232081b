"""``[rail.mount_stiffness]``: what it takes, and what it changes of a scene."""

import pytest

from tests.scenes.support import SMALL, small
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes import load, parse
from tipoff.scenes.rail_compliance import digest

JOINT = {"normal": "1e13 N/m^3", "shear": "5000 N/mm^3"}


def with_joint(**changed):
    return small(rail=SMALL["rail"] | {"mount_stiffness": JOINT | changed})


def test_stiffness_in_any_unit():
    assert parse(with_joint()).rail.joint() == MountStiffness(1e13, pytest.approx(5e12, rel=1e-14))
    assert load("reference").rail.joint() == pytest.approx((1e13, 5e12), rel=1e-14)
    assert load("clamped").rail.joint() is None


@pytest.mark.parametrize(
    "normal, shear, words",
    [
        ("1e13 N/m^3", "8e12 N/m^3", None),
        ("1e13 N/mm^3", "8e12 N/mm^3", "1e+22 and 8e+21 N/m3, plausible 1e+09 to 1e+16"),
        ("1e13 N/m^3", "2e13 N/m^3", "a shear stiffness below the normal one"),
    ],
)
def test_what_no_joint_has_is_warned_about(normal, shear, words):
    found = [
        line for line in parse(with_joint(normal=normal, shear=shear)).warnings if "mount_s" in line
    ]
    assert found == [] if words is None else len(found) == 1 and words in found[0]


def test_a_factor_multiplies_both():
    scene = parse(with_joint(factor=2.0))
    assert scene.rail.joint() == MountStiffness(2e13, pytest.approx(1e13, rel=1e-14))
    assert digest(scene) == digest(parse(with_joint()))
    assert scene.hash != parse(with_joint()).hash


def test_a_scene_without_it_is_the_same_as_before():
    """The key is in no record of such a scene; set and dropped again it leaves nothing."""
    plain = parse(small())
    assert "mount_stiffness" not in plain.physics()["rail"]
    soft = plain.replace({"rail.mount_stiffness.normal": 1e13, "rail.mount_stiffness.shear": 5e12})
    assert soft.hash != plain.hash and digest(soft) != digest(plain)
    assert parse(soft.resolved(), bare_numbers_are_si=True).hash == soft.hash
    dropped = soft.replace({"rail.mount_stiffness": None})
    assert dropped.hash == plain.hash and digest(dropped) == digest(plain)
    key = "rail.mount_stiffness"
    assert key in plain.absent_effects() and key not in soft.absent_effects()
