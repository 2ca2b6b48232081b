"""Blind conditions: drawn by a seed from the code and the scene, never fitted."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import scenes
from tipoff.faults import SceneError
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.studies.agreement import distributions, refinement, verdicts
from tipoff.studies.agreement.verdicts import Context
from tipoff.studies.blind import page
from tipoff.studies.blind import stage as blind
from tipoff.studies.blind.stage import CompareOptions
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.render import document
from tipoff.workspace.settings import Settings, defaults
from tipoff.workspace.store import Store
from tipoff.workspace.study import Study


def study_of(name: str = "reference") -> Study:
    return Study(scenes.load(name), Path("nowhere"), Settings())


def test_seed_is_that_of_code_and_scene(monkeypatch):
    own = blind.seed_of(study_of(), CompareOptions())
    assert (
        own
        == blind.seed_of(study_of(), CompareOptions())
        != blind.seed_of(study_of("sensitive"), CompareOptions())
    )
    assert blind.seed_of(study_of(), CompareOptions(seed=3)) == 3
    monkeypatch.setattr(blind.sources, "digest", lambda *modules: "another line of code")
    assert blind.seed_of(study_of(), CompareOptions()) != own


def test_drawn_conditions_are_all_held_out():
    drawn = blind.with_drawn_conditions(study_of(), CompareOptions(cases=3, seed=1))
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
    again = blind.with_drawn_conditions(study_of(), CompareOptions(cases=2, seed=1))
    assert [scene.hash for scene in again.conditions.values()] == [
        drawn.condition(name).hash for name in ("blind1", "blind2")
    ]


def test_no_drawn_condition_borrows_its_uncertainty(monkeypatch):
    """Mesh, step and cells on each. Control: a scene that refines one only has the others borrow, and
    says so."""
    drawn = blind.with_drawn_conditions(study_of(), CompareOptions(cases=3, seed=1))
    alone = replace(drawn, scene=drawn.scene.replace({"agreement.refined": ["blind2"]}))
    monkeypatch.setattr(
        type(drawn.store), "fill", lambda store, title, runs: [flight() for _ in runs]
    )
    for study, measured in ((drawn, [True, True, True]), (alone, [False, True, False])):
        context = Context([], refinement.refinements(study), verdicts.gates(study.scene))
        assert [context.uncertainty(name)[2] for name in drawn.conditions] == measured


def test_unknown_distributions_are_refused():
    with pytest.raises(SceneError, match="one of"):
        blind.with_drawn_conditions(study_of(), CompareOptions(vary="unheard"))


class Cases:
    """Settled rates (rad/s) as the ensemble gives them."""

    def __init__(self, values: np.ndarray):
        self.values = values

    def __getitem__(self, name):
        return self


def shifted(shift: float) -> list[float]:
    """Rates (deg/s) that the position (m) at ignition moves by 2 deg/s per um."""
    return [2e6 * shift, 0.0, 3.0]


@pytest.fixture
def stubbed(monkeypatch, tmp_path):
    """A study of ``tiny`` whose runs are made up: 1 um moves those of blind1 by 1 deg/s, the mesh those of
    blind2 by 1 deg/s for each halving, and nothing those of blind3. Both models are the same. Also the
    labels of the runs that were asked for."""
    asked = []

    def rate(run) -> list[float]:
        if "-neighbour-" in run.label:
            return shifted(run.scene.initial.position.y)
        twin = run.label.startswith("blind1") and "-clearance-" in run.label
        halvings = 2 * run.label.endswith("-coarsest") + run.label.endswith("-coarse")
        return [0.0, 0.0, 3.0 + twin + halvings * run.label.startswith("blind2")]

    def fill(store, title, runs):
        asked.extend(run.label for run in runs)
        return [
            flight(lambda t, run=run: np.tile(np.radians(rate(run)), (t.size, 1))) for run in runs
        ]

    def run_many(scene, rows, model, **_):
        return Cases(np.radians([shifted(row["initial.position.y"]) for row in rows]))

    monkeypatch.setattr(Store, "fill", fill)
    monkeypatch.setattr(distributions.lowfi, "run_many", run_many)
    monkeypatch.setattr(Study, "rail_compliances", lambda _, names, size=None: dict.fromkeys(names))
    monkeypatch.setattr(calibrate, "load", lambda study: None)
    monkeypatch.setattr(calibrate, "constants", lambda study: None)
    return Study(scenes.load("tiny"), tmp_path, defaults("tiny")), asked


def test_conditions_that_no_single_run_can_judge_are_judged_as_distributions(stubbed):
    """As in the agreement study, and both models agree there. Control: a condition that 1 um and the
    mesh do not move stays a curve, without neighbours."""
    study, asked = stubbed
    found = blind.run(study, CompareOptions(cases=3, seed=1, neighbours=32)).document
    for model in ("calibrated", "compliant"):
        assert [(row["condition"], row["judged_as"], row["judgement"]) for row in found[model]] == [
            ("blind1", "distribution", verdicts.AS_DISTRIBUTION),
            ("blind2", "distribution", verdicts.AS_DISTRIBUTION),
            ("blind3", "curve", verdicts.AGREES),
        ]
    assert [(item["condition"], item["neighbours"]) for item in found["distributions"]] == [
        ("blind1", 32),
        ("blind2", 8),  # 1 um does not move it, so a quarter is enough
    ]
    kept = {f"blind1-neighbour-{number}-coarse" for number in range(32)}
    assert kept <= set(asked) and not any("blind3-neighbour" in label for label in asked)
    sensitive = {
        item["condition"]: item["sensitive"]
        for item in found["growth"]
        if item["model"] == FINITE_ELEMENTS
    }
    assert sensitive == {"blind1": True, "blind2": False, "blind3": False}
    assert blind.STAGE.stored(study) is not None


def test_the_number_of_neighbours_is_that_of_the_settings_unless_one_is_given(stubbed):
    found = blind.run(stubbed[0], CompareOptions(cases=3, seed=1)).result
    assert [item.neighbours for item in found.distributions] == [5, 5]
    parts = page.draw(found)
    (figure,) = [part for part in parts if isinstance(part, document.Figure)]
    assert figure.chart.name == "blind-distributions"  # the agreement study has the other
