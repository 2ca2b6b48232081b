"""Random errors checked by the reference: the same cases in both models, and what follows from their
differences."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.studies import free_flight
from tests.validation.montecarlo.synthetic_draws import drawn, results
from tipoff.scenes import load
from tipoff.studies.populations import answers, draws, exceedance, random_factors
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.populations.reading import Reading
from tipoff.studies.render import chart
from tipoff.studies.render.document import terminal
from tipoff.workspace import store
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study
from validation.montecarlo import ENTRY, paired_statistics, tails, tails_page
from validation.montecarlo.options import Cases, MontecarloOptions

DRAWS = 10
OPTIONS = MontecarloOptions(Cases(cases=120, limits=("y=6 deg/s", "8 deg/s")), DRAWS)
# of this solver's and that one's steps, deg/s of some ten
ROUNDING = 1e-6


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return Study(
        free_flight.scene().replace(free_flight.BRIEF),
        tmp_path_factory.mktemp("out"),
        Settings(element_size=0.008, workers=1),
    )


@pytest.fixture(scope="module")
def kept(study):
    return tails.run(study, OPTIONS)


@pytest.fixture(scope="module")
def found(kept):
    return kept.result


def test_both_models_run_the_same_case(study, found):
    """Where nothing touches, both have the rates of the closed form. Control: each draw beside the
    next one."""
    rows = random_factors.source(study.scene, Reading(), DRAWS, 1).rows(0, DRAWS)
    rates = found.pairs.rates
    for axis, sign, tilts, arms in (
        ("y", 1.0, math.sin, math.cos),
        ("z", -1.0, math.cos, math.sin),
    ):
        exact = [sign * free_rate(row, tilts, arms) for row in rows]
        for model in ("reference", "surrogate"):
            # the attitude turns by some mrad while the thrust acts
            assert rates[f"rate_{axis}_deg_s"][model] == pytest.approx(exact, rel=5e-3, abs=0.01)
    reference, surrogate = (
        np.array([rates[f"rate_{axis}_deg_s"][model] for axis in "xyz"])
        for model in ("reference", "surrogate")
    )
    *_, everything = found.contacts
    assert everything.draws == DRAWS and everything.most < ROUNDING
    assert found.contacts[0].draws == DRAWS
    assert np.abs(reference - np.roll(surrogate, 1, axis=1))[1:].max(axis=0).min() > 0.01


def free_rate(row, tilts, arms) -> float:
    """deg/s; ``tilts`` and ``arms``, sine or cosine, take the angle of a tilt and of an arm."""
    tilt = row["thrust_offset.misalignment.axial"]
    moments = (
        free_flight.ARM * math.sin(tilt) * tilts(row["thrust_offset.misalignment.radial"]),
        row["thrust_offset.eccentricity.axial"] * arms(row["thrust_offset.eccentricity.radial"]),
        -row["mass_offset.eccentricity.axial"] * arms(row["mass_offset.eccentricity.radial"]),
    )
    return free_flight.RATE_PER_METRE * sum(moments)


def test_an_interrupted_study_makes_no_run_twice(study, kept, found, monkeypatch):
    """Without its result file the stage is made again from the stored runs."""
    monkeypatch.setattr(store, "execute", lambda *_, **__: pytest.fail("made again"))
    assert tails.run(study, OPTIONS) == kept == tails.STAGE.stored(study)
    study.path("tails.json").unlink()
    monkeypatch.setattr(chart, "to_files", lambda *_: [])  # drawn above
    again = tails.run(study, OPTIONS).result
    assert replace(again, cost=found.cost) == found
    more = replace(OPTIONS, draws=DRAWS + 1)
    with pytest.raises(pytest.fail.Exception, match="made again"):
        tails.run(study, more)


def test_what_is_printed(kept, found):
    tables = {f"tails_{name}.csv" for name in ("errors", "contacts", "statistics", "tails", "lost")}
    assert set(kept.document["files"]) == {"figures/tails.png", "figures/tails.svg", *tables}
    assert found.fine == 4 and found.element_size_m == 2.0 * found.fine_element_size_m
    # without contact no pad touches, and no springs stand beside
    assert "in 100 % of 10 draws" in terminal(tails_page.summary(found))
    assert tails_page.draw(found)


def test_runs_and_time_are_announced_before(study, found, capsys):
    wanted, finer, _ = draws.requests(study, nominal(study), [{}, {"payload.mass": 9.0}], 1)
    draws.announce(study, [*wanted, *finer])
    said = " ".join(capsys.readouterr().err.split())
    assert "2 of 2 runs of the reference on elements of 16 mm are to be made" in said
    assert "1 of 1 run of the reference on elements of 8 mm is to be made" in said
    assert "on one core" in said and "0.06 GB for each of 1" in said


def nominal(study) -> Surrogate:
    return Surrogate(study.scene, None, None, 0)


@pytest.mark.parametrize("reading", [Reading(), Reading(initial=True, interface=True)])
def test_the_reference_has_every_override_of_a_case(reading, tmp_path, monkeypatch):
    """Every key differs from the scene, and the scenes of a draw are equal in both models."""
    study = Study(load("reference"), tmp_path, Settings())
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: None)
    rows = random_factors.source(study.scene, reading, 5, 3).rows(0, 5)
    coarse, fine, beside = draws.requests(study, nominal(study), rows, 2)
    assert [run.scene.hash for run in coarse] == [run.scene.hash for run in beside]
    assert [run.scene.hash for run in fine] == [run.scene.hash for run in coarse[:2]]
    assert len({run.scene.hash for run in coarse}) == 5
    assert len({study.store.path(run) for run in (*coarse, *fine, *beside)}) == 12
    assert {run.numerics.element_size for run in coarse} == {0.004}
    for key, value in rows[1].items():
        found = coarse[1].scene
        for part in key.split("."):
            found = found["xyz".index(part)] if isinstance(found, tuple) else getattr(found, part)
        assert found == pytest.approx(value, rel=1e-12)


def test_errors_by_number_of_contacts():
    """Errors of 0.01, 0.05, 0.3, 0.02 and 2 deg/s, one of them about each axis; one draw did not
    settle. Five contacts and seven are in one row."""
    reference = np.zeros((6, 3))
    errors = [(0.01, 0, 0), (0, -0.05, 0), (0, 0, 0.3), (0.02, 0, 0), (0, 2, 1), (np.nan,) * 3]
    rows = paired_statistics.by_contacts(drawn(reference, errors, [0, 1, 1, 3, 5, 7]), 0.1)
    assert [(row.contacts, row.draws, row.settled) for row in rows] == [
        ("0", 1, 1), ("1", 2, 2), ("2", 0, 0), ("3", 1, 1), ("4 or more", 2, 1), ("all", 6, 5),
    ]  # fmt: skip
    assert [row.most for row in rows] == pytest.approx([0.01, 0.3, None, 0.02, 2.0, 2.0])
    assert rows[1].within_gate == 0.5 and rows[-1].within_gate == pytest.approx(0.6)
    assert rows[-1].low < 0.6 < rows[-1].high


def test_a_biased_surrogate_is_corrected_and_a_case_that_does_not_settle_is_above():
    random = np.random.default_rng(4)
    truth = random.normal(0.0, 3.0, (4000, 3))
    surrogate = 1.2 * truth + 0.5
    reference = truth[:50] + random.normal(0.0, 0.02, (50, 3))
    reference[7] = np.nan
    both = drawn(reference, surrogate[:50], np.ones(50))
    whole = Population(
        {}, results(surrogate), "store", {}, Surrogate(free_flight.scene(), None, None, 0)
    )
    rows = {
        row.statistic: row for row in paired_statistics.statistics(answers.RATES[1], both, whole)
    }
    assert rows["mean"].value == pytest.approx(truth[:, 1].mean(), abs=0.02)
    assert rows["mean"].surrogate == pytest.approx(truth[:, 1].mean() * 1.2 + 0.5)
    assert rows["standard deviation"].value == pytest.approx(truth[:, 1].std(), rel=0.01)
    assert rows["mean"].equivalent_runs > 1000
    best = paired_statistics.optimal(answers.RATES[1], both, whole, 1e4)
    assert best.correlation > 0.9999 and best.variance_ratio < 0.01
    limit = exceedance.Limit("y", 5.0)
    found = paired_statistics.tail(limit, both.reference, whole.results)
    above = np.abs(reference[:, 1]) > 5.0
    assert found.above == above.sum() + 1
    assert found.missed == 1 + (above & (np.abs(surrogate[:50, 1]) <= 5.0)).sum()
    assert found.low < (np.abs(truth[:, 1]) > 5.0).mean() < found.high


def test_the_command_refuses_before_it_computes(tmp_path, call):
    arguments = ["--cases", "100", "--reference", "5", "--finer", "9"]
    told = call(*ENTRY.commands, [*arguments, "--limit", "w=1 deg/s", "--out", str(tmp_path)])
    assert told.exit_code == 2 and list(tmp_path.iterdir()) == []
    assert all(words in told.stderr for words in ("10 to 100", "4 to 5", "w=1 deg/s"))
