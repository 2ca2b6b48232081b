"""Predicted settled rates: as many references inside the intervals as these say, and words for it on the page."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import calibrate
import lowfi
import scenes
from studies.agreement import prediction
from studies.report import posterior as page
from studies.report.chart import to_html
from studies.settings import Settings
from studies.stages import posterior as stage
from studies.study import Study
from tests.lowfi.test_bow import MEAN, standing_away
from tests.studies.synthetic import flight

DRAWS, SIZE, FREEDOM = 200, 0.08, 6.0
POSTERIOR = SimpleNamespace(settled_size=[[SIZE] * 3] * DRAWS, settled_freedom=FREEDOM)


def rows(conditions: int) -> list[dict]:
    """Surrogates whose constants scatter by 1 % of each rate, references with a discrepancy as large as the posterior says."""
    generator, found = np.random.default_rng(46), []
    for number in range(conditions):
        rate = 0.05 * generator.standard_normal(3)
        drawn = rate * (1.0 + 0.01 * generator.standard_normal((DRAWS, 3)))
        reference = rate + np.linalg.norm(rate) * SIZE * generator.standard_t(FREEDOM, 3)
        found.append(prediction.row(f"c{number}", "held_out", POSTERIOR, drawn, reference.tolist(), seed=number))
    return found


@pytest.fixture(scope="module")
def many() -> list[dict]:
    return rows(300)


@pytest.mark.case("O45")
def test_as_many_references_lie_inside_as_the_intervals_say(many):
    """900 values, the axes independent here: 95 % of them within their 99.9 % band, for quantiles of 200 draws are rough. Control:
    what the constants leave open holds few."""
    found = prediction.coverage(many)
    assert found["values"] == 900 and found["band"] == [842, 867]
    assert 831 <= found["total"] <= 876, found
    assert found["parameter"] < 450, found


def test_a_case_that_does_not_settle_is_counted_out():
    drawn = np.full((DRAWS, 3), 0.1)
    drawn[:50] = np.nan
    part = prediction.row("a", "fitted", POSTERIOR, drawn, [0.1, 0.1, 0.1])
    assert part["settled"] == 150 and part["parameter_holds"] == [True] * 3
    none = prediction.row("a", "fitted", POSTERIOR, np.full((DRAWS, 3), np.nan), [0.1, 0.1, 0.1])
    assert none["settled"] == 0 and none["total_deg_s"] is None
    unknown = prediction.row("a", "fitted", POSTERIOR, drawn, None)
    assert unknown["total_holds"] is None and unknown["total_deg_s"] is not None
    free = prediction.row("a", "fitted", POSTERIOR, drawn, [0.1, 0.1, 0.1], touches=False)
    unsure = prediction.row("d", "fitted", POSTERIOR, drawn, [9.0, 9.0, 9.0], converged=False)
    found = prediction.coverage([part, none, unknown, free, unsure])
    assert found["values"] == found["total"] == 3 and found["not_judged"] == ["d"]
    assert prediction.covered({"held_out": found}).endswith("(95 % band 2 to 3) (reference not converged, so not judged: d)")
    assert prediction.covered({"held_out": prediction.coverage([unsure])}) == (
        "no held-out settled rate can be judged (reference not converged, so not judged: d)")
    assert prediction.coverage([])["values"] == 0
    beside = prediction.row("b", "fitted", POSTERIOR, drawn, [0.1, 9.0, 0.1])
    assert prediction.covered({"fitted": prediction.coverage([part, beside])}).endswith(", not in b (y)")


FEW = SimpleNamespace(draws={"friction.static": [0.1, 0.2], "friction.dynamic": [0.1, 0.2]}, settled_size=[[SIZE] * 3] * 2)
COLD = scenes.load("reference").condition("phi60")
WARM = COLD.replace({"thermal.mean": MEAN, "flexibility.modes": 4})


def test_draws_run_on_springs_that_stand_on_the_walls_given(monkeypatch):
    """Whether rails are warm, and vibrate, or not."""
    given = []

    def run_many(scene, rows, workers, numerics, walls):
        given.append((scene.thermal is None, scene.flexibility, rows, workers, walls))
        return SimpleNamespace(rate=SimpleNamespace(values=np.zeros((len(rows), 3))))

    monkeypatch.setattr(lowfi, "run_many", run_many)
    prediction.rates(FEW, {"warm": WARM, "cold": COLD}, 3, walls="rigid walls")
    rows = calibrate.draws(FEW)
    assert given == [(False, None, rows, 3, "rigid walls"), (True, None, rows, 3, "rigid walls")]


@pytest.mark.slow
def test_rates_of_warm_rails_that_vibrate_are_those_of_springs_on_them():
    """Walls 50 um wider where they are warm. Controls: without walls or with rails that vibrate nothing runs, and cold rails give
    other rates."""
    walls, numerics = standing_away(WARM, np.full(4, 5e-5)), lowfi.Numerics(relative_tolerance=prediction.TOLERANCE)
    found = prediction.rates(FEW, {"warm": WARM, "cold": COLD}, walls=walls)
    for rate, row in zip(found["warm"], calibrate.draws(FEW)):
        assert rate.tolist() == lowfi.run(WARM.replace(row | {"flexibility": None}), numerics=numerics, walls=walls).outcome.rate
    assert np.abs(found["warm"] - found["cold"]).max() > 1e-3
    with pytest.raises(scenes.SceneError, match="thermal"):
        prediction.rates(FEW, {"warm": WARM})
    with pytest.raises(scenes.SceneError, match="flexibility"):
        lowfi.run_many(WARM, calibrate.draws(FEW), walls=walls)


@pytest.fixture
def staged(monkeypatch, tmp_path):
    """The stage on a warm scene with nothing run: its study, and what it handed on by name."""
    study = Study(scenes.load("tiny").replace({"thermal.mean": "20 K"}), tmp_path / "tiny", Settings(workers=3))
    given, turning = {}, flight(lambda t: np.full((t.size, 3), 0.1))
    drawn = SimpleNamespace(chain={"effective": 1.0, "steps": 1, "walkers": 1, "doubts": []}, settled_size=[[SIZE] * 3] * 4,
                            settled_freedom=FREEDOM, as_dict=lambda: {"chain": {"doubts": []}})

    def posterior(scene, references, calibration, progress, **others):
        given["posterior"] = others
        return drawn

    def rates(posterior, conditions, workers, progress, walls):
        given["rates"] = {"workers": workers, "walls": walls}
        return {name: np.full((4, 3), 0.1) for name in conditions}

    monkeypatch.setattr(calibrate, "posterior", posterior)
    monkeypatch.setattr(prediction, "rates", rates)
    monkeypatch.setattr(stage.calibration_stage, "load", lambda study: SimpleNamespace(constants={}))
    monkeypatch.setattr(stage.calibration_stage, "as_dict", lambda found: {"intervals": []})
    monkeypatch.setattr(stage.calibration_stage.walls, "of_law", lambda study, scene: "rigid walls" if scene.thermal else None)
    monkeypatch.setattr(stage.compare, "refinements", lambda study: [])
    monkeypatch.setattr(type(study.store), "fill", lambda store, title, runs: [turning] * len(runs))
    return study, given


def test_the_stage_hands_on_workers_and_the_walls_of_a_warm_scene(staged, capsys):
    """And says beforehand how long it takes. Control: a cold scene has no walls."""
    study, given = staged
    stage.run(study)
    assert given["posterior"] == given["rates"] == {"walls": "rigid walls", "workers": 3}
    assert "; then the draws, at most about" in capsys.readouterr().err
    stage.run(replace(study, scene=scenes.load("tiny")))
    assert given["posterior"]["walls"] is given["rates"]["walls"] is None


def document(predicted: list[dict]) -> dict:
    """What the stage writes, of two constants, one not told."""
    profile = {"value": [1.0, 2.0, 3.0], "drop": [-3.0, 0.0, -30.0]}
    chain = {"doubts": ["<short>"], "walkers": 8, "steps": 90, "accepted": 0.3, "autocorrelation_steps": [9.0, 11.0],
             "effective": 65.0, "evaluations": 720, "seed": 0}
    return {"parameters": ["contact.force", "contact.damping_depth"], "units": ["N", "m"], "best": [2.0, 2.0],
            "logarithmic": [True, False], "intervals": [[1.5, 2.5], None], "without": [[1.9, 2.1], None], "linear": [[1.8, 2.2]],
            "spread": [0.05, 0.99],
            "notes": ["contact.damping_depth: its posterior is its prior"], "correlation": [[1.0, 0.1], [0.1, 1.0]],
            "profile": {"contact.force": profile, "contact.damping_depth": profile},
            "samples": {name: [1.0, 2.0, 2.0, 3.0] for name in ("contact.force", "contact.damping_depth")},
            "errors": {"velocity_x": {"relative_size": 1e-4, "correlation_time_s": 8e-3, "independent": 30.6, "samples": 480}},
            "chain": chain, "predicted": predicted, "coverage": {"held_out": prediction.coverage(predicted)}}


def test_page_shows_intervals_side_by_side_and_what_is_not_told():
    found = document(rows(4) + [prediction.row("still", "fitted", POSTERIOR, np.full((DRAWS, 3), np.nan), None)])
    shown = page.tables(found)
    assert ">1.5 to 2.5<" in shown and ">1.9 to 2.1<" in shown and ">1.8 to 2.2<" in shown and ">not told<" in shown
    assert "its posterior is its prior" in shown and "Not converged: &lt;short&gt;" in shown
    assert "of 12 held-out settled rates" in shown
    chart = page.picture(found)
    assert [panel.title for panel in chart.panels] == ["contact.force", "contact.damping_depth", "roll rate", "y rate", "z rate"]
    assert min(min(line.y) for line in chart.panels[0].lines) >= -8.0
    assert 'id="chart-posterior"' in to_html(chart)
