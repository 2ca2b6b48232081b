"""Predicted settled rates: as many references inside the intervals as these say, and words for it on the page."""

from types import SimpleNamespace

import numpy as np
import pytest

from studies.agreement import prediction
from studies.report import posterior as page
from studies.report.chart import to_html

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
    assert prediction.coverage([part, none, unknown, free])["values"] == 3
    assert prediction.coverage([])["values"] == 0
    beside = prediction.row("b", "fitted", POSTERIOR, drawn, [0.1, 9.0, 0.1])
    assert prediction.missed(prediction.coverage([part, beside])) == ", not in b (y)"


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
    assert "of 12 settled rates of held-out" in shown
    chart = page.picture(found)
    assert [panel.title for panel in chart.panels] == ["contact.force", "contact.damping_depth", "roll rate", "y rate", "z rate"]
    assert min(min(line.y) for line in chart.panels[0].lines) >= -8.0
    assert 'id="chart-posterior"' in to_html(chart)
