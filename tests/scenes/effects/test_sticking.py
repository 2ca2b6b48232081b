"""The table of the law that sticks, and the two-step law, which is the default."""

import pytest

from tests.scenes.support import CONTACT, FRICTION, STICKING, small
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.sticking import Sticking
from tipoff.scenes import launch, load, parse, scene_model


def test_record():
    scene = parse(small(contact=CONTACT, friction=STICKING))
    found = scene_model.build(scene)
    assert found.friction == pytest.approx(Sticking(0.4, 0.3, 1e7, 1e4, 1e-6))
    assert launch.of_scene(scene).slow == 0.01


def test_a_table_without_a_law_is_two_step():
    """With or without the name it is the same scene: same records, same hash, same file."""
    silent, named = (
        parse(small(contact=CONTACT, friction=table))
        for table in (FRICTION, FRICTION | {"law": "two-step"})
    )
    assert silent.hash == named.hash and silent.resolved() == named.resolved()
    assert isinstance(scene_model.build(named).friction, Friction)
    assert "law" not in silent.resolved()["friction"]


def test_resolved_scene_reads_back():
    scene = load("reference").replace({"friction": STICKING})
    again = parse(scene.resolved(), bare_numbers_are_si=True)
    assert again.hash == scene.hash != load("reference").hash
    assert again.friction == scene.friction


def test_one_law_becomes_the_other_by_its_keys():
    scene = load("reference").replace(
        {
            "friction.law": "sticking",
            "friction.stiffness": 1e7,
            "friction.damping": 0.0,
            "friction.static_speed": "absent",
            "friction.dynamic_speed": "absent",
        }
    )
    assert scene.friction.static == 0.2 and scene.friction.capture_speed == 1e-6
