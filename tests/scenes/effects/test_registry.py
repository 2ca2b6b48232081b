"""All effects come from one list: one more entry is one more effect."""

import re
from pathlib import Path

import pytest

from tests.scenes.support import small
from tipoff.mechanics import ledger
from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.scenes import scene as scenes
from tipoff.scenes import scene_model
from tipoff.scenes.effects import registry
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.table import Table
from tipoff.scenes.units import Acceleration


class LiftTable(Table):
    """A body force that no scene has."""

    up: Acceleration

    def body_force(self) -> BodyForce:
        return BodyForce(0.0, 0.0, self.up)


class Lifted(scenes.Scene):
    """A scene with one more effect."""

    lift: LiftTable | None = None


@pytest.fixture(autouse=True)
def one_more(monkeypatch):
    effects = (*registry.EFFECTS, Effect("lift", is_body_force=True))
    for module in (registry, scenes):
        monkeypatch.setattr(module, "EFFECTS", effects)


def lifted(**tables) -> Lifted:
    return Lifted.model_validate(small(**tables), context={"bare_numbers_are_si": True})


def test_a_new_body_force_reaches_the_solvers():
    assert scene_model.build(lifted(lift={"up": 0.5})).body_force == (0.0, 0.0, 0.5)
    both = lifted(lift={"up": 0.5}, gravity={"y": 2.0, "z": -1.0})
    assert scene_model.build(both).body_force == (0.0, 2.0, -0.5)
    assert registry.body_forces(both) == {"gravity": (0.0, 2.0, -1.0), "lift": (0.0, 0.0, 0.5)}
    assert scene_model.build(lifted()).body_force is None


def test_a_new_effect_is_listed_where_it_is_absent():
    assert lifted().absent_effects()[-1] == "lift"
    assert "lift" not in lifted(lift={"up": 0.5}).absent_effects()


def test_names_of_the_ledger_stay():
    first = next(effect.key for effect in registry.EFFECTS if effect.is_body_force)
    assert ledger.WORK == ("thrust", first) == ("thrust", "gravity") and ledger.ENTRIES[:3] == (
        *ledger.WORK,
        "kinetic",
    )


def test_an_effect_is_named_in_its_file_the_registry_and_the_scene():
    package = Path(registry.__file__).parents[2]
    folders = ("scenes", "mechanics", "calibration", "meshes", "kernels", "highfi", "lowfi")
    paths = [path for folder in folders for path in (package / folder).rglob("*.py")]
    named = {path.name for path in paths if re.search(r"\bgravity\b", path.read_text())}
    # which way is up on the ground, whether a payload has a weight to rest with, and the name of the
    # entry of all body forces
    others = {"hand_over.py", "body.py", "settled.py", "ledger.py", "from_rocketpy.py"}
    assert named == {"gravity.py", "registry.py", "scene.py"} | others
