"""Blind conditions: drawn by a seed from the code and the scene, never fitted."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.scenes.faults import SceneError
from tipoff.studies.agreement import refined
from tipoff.studies.agreement.verdicts import Context
from tipoff.studies.blind import stage as blind
from tipoff.studies.blind.stage import Options
from tipoff.studies.core.settings import Settings
from tipoff.studies.core.study import Study


def study_of(name: str = "reference") -> Study:
    return Study(scenes.load(name), Path("nowhere"), Settings())


def test_seed_is_that_of_code_and_scene(monkeypatch):
    own = blind.seed_of(study_of(), Options())
    assert (
        own
        == blind.seed_of(study_of(), Options())
        != blind.seed_of(study_of("sensitive"), Options())
    )
    assert blind.seed_of(study_of(), Options(seed=3)) == 3
    monkeypatch.setattr(blind.sources, "digest", lambda *modules: "another line of code")
    assert blind.seed_of(study_of(), Options()) != own


def test_drawn_conditions_are_all_held_out():
    drawn = blind.draw(study_of(), Options(cases=3, seed=1))
    assert (
        list(drawn.conditions)
        == ["blind1", "blind2", "blind3"]
        == list(drawn.scene.agreement.held_out)
    )
    assert (
        drawn.scene.agreement.fitted == ()
        and drawn.scene.agreement.floor == drawn.scene.agreement.held_out
    )
    hashes = {scene.hash for scene in drawn.conditions.values()}
    assert len(hashes) == 3 and hashes.isdisjoint(
        scene.hash for scene in study_of().conditions.values()
    )
    again = blind.draw(study_of(), Options(cases=2, seed=1))
    assert [scene.hash for scene in again.conditions.values()] == [
        drawn.condition(name).hash for name in ("blind1", "blind2")
    ]


def test_no_drawn_condition_borrows_its_uncertainty(monkeypatch):
    """Mesh, step and cells on each. Control: a scene that refines one only has the others borrow, and
    says so."""
    drawn = blind.draw(study_of(), Options(cases=3, seed=1))
    alone = replace(drawn, scene=drawn.scene.replace({"agreement.refined": ["blind2"]}))
    monkeypatch.setattr(
        type(drawn.store), "fill", lambda store, title, runs: [flight() for _ in runs]
    )
    for study, measured in ((drawn, [True, True, True]), (alone, [False, True, False])):
        context = Context([], refined.refinements(study), {})
        assert [context.uncertainty(name)[2] for name in drawn.conditions] == measured


def test_unknown_distributions_are_refused():
    with pytest.raises(SceneError, match="one of"):
        blind.draw(study_of(), Options(vary="unheard"))
