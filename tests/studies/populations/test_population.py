"""Many cases on the surrogate of a study: the store, the model, and the reported quantities."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.pushed import heavy_and_tilted
from tests.studies import free_flight
from tests.studies.agreement.made import ROW, table
from tipoff import lowfi
from tipoff.lowfi.ensemble.rows import Listed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes import load
from tipoff.studies.limits import stage as limits
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, StudyError
from validation.montecarlo import stage as montecarlo

SCENE = load("reference")
FLEXIBLE = SimpleNamespace(flexibility=1.0)


@pytest.mark.parametrize("model", [None, COMPLIANT])
def test_compliant_contact_is_the_default_and_needs_no_calibration(tmp_path, monkeypatch, model):
    monkeypatch.setattr(population.calibrate, "load", lambda _: pytest.fail("fitted springs"))
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: FLEXIBLE)
    found = population.surrogate(Study(SCENE, tmp_path, Settings()), model)
    assert found.name == found.words == COMPLIANT and found.scene.hash == SCENE.hash


def test_springs_are_used_where_they_are_named(tmp_path, monkeypatch):
    monkeypatch.setattr(
        Study, "rail_compliance", lambda *_, **__: pytest.fail("found a compliance")
    )
    monkeypatch.setattr(
        population.calibrate, "load", lambda _: SimpleNamespace(apply=lambda scene: scene)
    )
    found = population.surrogate(Study(SCENE, tmp_path, Settings()), SPRINGS)
    assert found.name == SPRINGS and found.words == "springs, calibrated"


def test_a_model_that_the_agreement_table_rejects_must_be_named(tmp_path, monkeypatch):
    """Control: a reference that is not converged rejects nothing, nor does another condition."""
    missed = replace(
        ROW, condition="h1", judgement="misses", verdict="misses: settled rate 3 x limit"
    )
    lost = replace(ROW, condition="h8", reference_converged=False, judgement="cannot be judged")
    found = table(compliant=(missed, lost))
    monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _: found)
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: FLEXIBLE)
    study = Study(SCENE, tmp_path, Settings())
    for condition in (None, "h1"):
        with pytest.raises(
            StudyError, match="h1: misses: settled rate 3 x limit\n.*--model finite-elements"
        ):
            population.surrogate(study, None, condition)
        assert population.surrogate(study, COMPLIANT, condition).name == COMPLIANT
    assert (
        population.surrogate(study, None, "h8").name
        == population.surrogate(study, None, "h2").name
        == COMPLIANT
    )


def test_numbers_of_springs_vary(tmp_path):
    """Preload, rate, place, mass and direction of a spring are inputs of a case, as they are in the
    scene. Control: each changes the rates of a payload that nothing touches."""
    table = heavy_and_tilted()
    scene = free_flight.scene().replace({"thrust": table, **free_flight.BRIEF})
    first = table["springs"][0]
    rows = [
        {f"thrust.springs.0.{name}": value}
        for name, value in (
            ("preload", 1.1 * first["preload"]),
            ("rate", 1.1 * first["rate"]),
            ("y", first["y"] + 1e-3),
            ("mass", 0.6),
            ("misalignment.axial", 0.03),
            ("misalignment.radial", 1.0),
        )
    ]
    model = Surrogate(scene, None, None)
    found = population.run(Study(scene, tmp_path, Settings(workers=1)), "s", model, Listed(rows))
    numerics = Numerics.of_many(population.TOLERANCE, model="springs")
    nominal, *alone = (
        lowfi.run(scene.replace(row), "springs", numerics=numerics).outcome.rate
        for row in ({}, *rows)
    )
    np.testing.assert_array_equal(found.results.rate, alone)
    # Control:
    assert (np.abs(np.subtract(alone, nominal)).max(axis=1) > 1e-4).all()


def test_cases_are_kept_and_not_run_again(tmp_path, monkeypatch):
    study = Study(SCENE, tmp_path, Settings(workers=1))
    rows = [{"thrust_offset.misalignment.radial": angle} for angle in (0.3, 0.6)] + [
        {"thrust_offset.misalignment.radial": float("nan")}
    ]
    found = population.run(study, "trial", Surrogate(SCENE, None, None), Listed(rows))
    alone = lowfi.run(
        SCENE.replace(rows[1]),
        "springs",
        numerics=Numerics.of_many(population.TOLERANCE, model="springs"),
    ).outcome
    assert found.counts == {
        "asked": 3,
        "ok": 2,
        "refused": 1,
        "failed": 0,
    } and found.settled.tolist() == [True, True, False]
    values = {item.name: item.of(found.results)[1] for item in answers.ALL}
    assert [values[f"rate_{axis}_deg_s"] for axis in "xyz"] == np.degrees(alone.rate).tolist()
    assert values["lateral_velocity_mm_s"] == 1e3 * alone.lateral_velocity and values[
        "direction_error_deg"
    ] == np.degrees(alone.direction_error)
    assert [values[f"attitude_{axis}_deg"] for axis in "xyz"] == np.degrees(
        alone.exit_attitude
    ).tolist()
    monkeypatch.setattr(
        "tipoff.lowfi.ensemble.fill.completed", lambda *_: pytest.fail("ran a stored case again")
    )
    again = population.run(study, "trial", Surrogate(SCENE, None, None), Listed(rows))
    assert (
        np.array_equal(again.results.rate, found.results.rate, equal_nan=True)
        and (tmp_path / again.store).is_dir()
    )


@pytest.mark.parametrize("study_of", [limits.run, montecarlo.run], ids=["limits", "montecarlo"])
def test_a_scene_that_never_leaves_is_refused_before_thousands_of_cases(
    study_of, tmp_path, monkeypatch
):
    """Without a stated duration such a run is jammed after 5 ms. Control: the same launch with its
    thrust goes on to its cases."""

    class Began(Exception):
        pass

    def begin(*_, **__):
        raise Began

    monkeypatch.setattr(population, "run", begin)
    monkeypatch.setattr(limits.Search, "all", begin)
    moving = free_flight.scene().replace({"duration": None})
    still = moving.replace({"thrust.peak": 0.0})
    with pytest.raises(Began):
        study_of(Study(moving, tmp_path / "moving", Settings(workers=1)))
    with pytest.raises(
        StudyError, match=r"does not leave the rail and settle \(jammed: stuck.*nothing moved"
    ):
        study_of(Study(still, tmp_path / "still", Settings(workers=1)))
