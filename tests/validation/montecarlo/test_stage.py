"""The study of random errors as a whole, on a launch without contact, where the distribution of the
rates is known."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.special import j0

from tests.studies import free_flight
from tests.studies.shown import html
from tipoff.lowfi.ensemble import columns
from tipoff.scenes import load
from tipoff.studies.populations import answers, population, spread
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.render import chart
from tipoff.studies.render.document import terminal
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, StudyError
from validation.montecarlo import ENTRY
from validation.montecarlo import page as pictures
from validation.montecarlo import stage as montecarlo
from validation.montecarlo.options import Cases as MontecarloOptions

OPTIONS = MontecarloOptions(cases=1500, limits=("y=6 deg/s", "8 deg/s"))


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return Study(free_flight.scene(), tmp_path_factory.mktemp("out"), Settings(workers=2))


@pytest.fixture(scope="module")
def kept(study):
    return montecarlo.run(study, OPTIONS)


@pytest.fixture(scope="module")
def found(kept):
    return kept.result


def test_what_is_written_is_whole_and_not_made_again(study, kept, found, monkeypatch):
    assert found.counts == {"asked": 1500, "ok": 1500, "refused": 0, "failed": 0}
    assert found.model == "compliant or springs, which are the same without contact"
    assert [item.name for item in found.quantities] == [item.name for item in answers.ALL]
    figures = [
        f"figures/montecarlo-{name}.{kind}"
        for name in ("histograms", "convergence")
        for kind in ("png", "svg")
    ]
    tables = [
        f"montecarlo_{name}.csv" for name in ("quantities", "tails", "convergence", "readings")
    ]
    assert set(kept.document["files"]) == {*figures, *tables}
    # no springs and no clearance without contact
    assert found.models is None and len(found.readings) == 7
    assert found.models_missing in terminal(pictures.summary(found))
    monkeypatch.setattr(
        "tipoff.studies.populations.population.run", lambda *_: pytest.fail("made again")
    )
    assert montecarlo.run(study, OPTIONS) == kept == montecarlo.STAGE.stored(study)
    assert json.loads(study.path("montecarlo.json").read_text()) == kept.document


def test_the_first_thousand_are_the_paper_s_and_bounds_shrink_with_the_root_of_the_number(found):
    item = found.quantities[1]
    first, whole = item.first[2], item.quantiles[2]
    assert first.low < first.value < first.high and first != whole
    assert {row.name for row in found.convergence} == {
        "rate_x_deg_s",
        "rate_y_deg_s",
        "rate_z_deg_s",
        "rate_deg_s",
    }
    # nothing turns this payload about x
    for name in ("rate_y_deg_s", "rate_z_deg_s", "rate_deg_s"):
        rows = [row for row in found.convergence if row.share == 0.5 and row.name == name]
        assert [row.cases for row in rows] == [100, 200, 500, 1000, 1500]
        halves = [0.5 * (row.high - row.low) for row in rows]
        # The slope is -1/2; ranks are whole numbers and densities estimated, so single widths
        # scatter by some 20 %.
        assert np.polyfit(np.log([row.cases for row in rows]), np.log(halves), 1)[
            0
        ] == pytest.approx(-0.5, abs=0.15)


def counted(cases, lost):
    """Case n has every number n, and those of ``lost`` did not settle."""
    number = np.arange(float(cases))
    number[lost] = np.nan
    each = columns.Columns(
        *[
            np.radians(np.column_stack([number] * 3)) if name in columns.VECTORS else number
            for name in columns.Columns._fields
        ]
    )
    return Population(
        {}, each, "store", {"refused": 0}, Surrogate(free_flight.scene(), None, None, 0)
    )


def test_a_part_of_the_cases_is_their_first_whether_they_settled_or_not():
    """Case 1,000 is not among the first thousand because an earlier one did not settle."""
    found = counted(1200, slice(0, 300))
    item = montecarlo.distribution(answers.RATES[0], found)
    assert item.first[2].value == pytest.approx(649.5) and item.quantiles[2].value == pytest.approx(
        749.5
    )
    assert sum(item.histogram.first) > 0.0
    assert montecarlo.distribution(answers.RATES[0], counted(1200, slice(0, 1000))).first is None
    rows = spread.convergence(answers.RATES[0].of(found.results), (0.5,))
    assert [(cases, round(row.value, 6)) for cases, row in rows] == [
        (500, 399.5),
        (1000, 649.5),
        (1200, 749.5),
    ]


@pytest.mark.parametrize("drawn", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_cases_that_do_not_settle_elsewhere_are_reported_and_stop_nothing(
    tmp_path, monkeypatch, drawn
):
    """Neither in another reading nor on the other surrogate. The study itself needs settled
    cases. Drawing its charts takes longer than all else."""
    study = Study(free_flight.scene(), tmp_path, Settings(workers=2))
    if not drawn:
        monkeypatch.setattr(chart, "to_files", lambda *_: [])
    run, seen = population.run, []

    def spoilt(*arguments):
        seen.append(arguments[1])
        if len(seen) == 4:
            return counted(120, slice(0, 119))
        return run(*arguments)

    monkeypatch.setattr(population, "run", spoilt)
    found = montecarlo.run(study, MontecarloOptions(cases=120, limits=("8 deg/s",))).result
    row = found.readings[2]
    assert (
        row.settled == 1
        and row.rates is row.distance is None
        and found.readings[0].distance is not None
    )
    assert f"too few settled cases to compare: {row.reading}\n" in terminal(pictures.summary(found))
    assert "1 settled" in html(pictures.draw(found))
    monkeypatch.setattr(population, "run", lambda *_: counted(120, slice(None)))
    with pytest.raises(StudyError, match="no case settled"):
        montecarlo.run(study, MontecarloOptions(cases=120, seed=2, limits=("8 deg/s",)))
    monkeypatch.setattr(population, "surrogate", lambda *_: counted(9, slice(0, 9)).model)
    touching = Study(load("reference"), study.folder, study.settings)
    # no springs calibrated
    assert (
        montecarlo.compared(touching, MontecarloOptions(cases=120), counted(120, slice(0, 9)))
        is None
    )
    monkeypatch.setattr(montecarlo.calibrate, "stored", lambda _: {"key": "k"})
    models = montecarlo.compared(touching, MontecarloOptions(cases=120), counted(120, slice(0, 9)))
    assert models.both_settled == 0 and models.quantities == ()
    both = replace(found, models=models)
    assert "No case of 120 settled in both models" in html(pictures.draw(both))
    assert len(pictures.figures(both)) == 2
    assert "no case settled in both models" in terminal(pictures.summary(both))


def test_tails_hold_the_probability_by_independent_quadrature(found):
    """w_y is a sum of (normal cut at 3 sigma) times (cosine of a uniform angle): its tail from
    characteristic functions, on a grid."""
    grid = np.linspace(-3.0, 3.0, 601)
    weights, frequency = (
        stats.truncnorm(-3.0, 3.0).pdf(grid) * (grid[1] - grid[0]),
        np.linspace(1e-6, 12.0, 6000),
    )
    weights /= weights.sum()
    transform = np.ones_like(frequency)
    for sd in (
        free_flight.RATE_PER_RADIAN * np.radians(0.4) / 3.0,
        free_flight.RATE_PER_METRE * 0.2e-3,
        free_flight.RATE_PER_METRE * 0.4e-3 / 3.0,
    ):
        transform = transform * (weights[:, None] * j0(np.outer(grid, frequency) * sd)).sum(axis=0)
    above = 1.0 - 2.0 / np.pi * np.trapezoid(
        transform * np.sin(6.0 * frequency) / frequency, frequency
    )
    tail = found.tails[0]
    assert tail.limit == "rate about y 6 deg/s" and tail.low < above < tail.high
    # the bounds are narrow enough to say something
    assert not tail.low < 1.5 * above < tail.high


def test_readings_with_equal_distributions_have_no_significant_distance(found):
    rows = {row.reading: row for row in found.readings}
    same, half = (
        rows[f"{kind} normal, three angles, redrawn beyond 3 sigma"] for kind in ("signed", "half")
    )
    assert same.same and not half.same and min(same.chance, half.chance) > 0.01
    assert rows["two normal components, redrawn beyond 3 sigma"].chance < 1e-6
    assert rows["half normal, one angle, redrawn beyond 3 sigma"].chance < 0.01


def test_distance_and_probability_of_two_samples():
    random = np.random.default_rng(1)
    one, two = random.normal(size=(2, 2000))
    assert (
        spread.apart([one, one], [two, two])[1] > 0.05
        and spread.apart([one], [two + 0.3])[1] < 1e-6
    )
    # Kolmogorov and Smirnov: two samples of three, one wholly above the other.
    assert spread.apart([np.arange(3.0)], [np.arange(3.0) + 5.0])[0] == 1.0


def test_bad_input_is_refused_and_nothing_written(tmp_path, call):
    arguments = ["--out", str(tmp_path / "out"), "--cases", "100"]
    for more, words in (
        (["--limit", "w=1 deg/s", "--limit", "x=1 mm"], ("--limit", "w=1", "1 mm", "2 faults")),
        (
            ["--reading", "components", "--angles", "shared", "--limit", "5 K"],
            ("--angles", "--limit", "2 faults"),
        ),
        (["--reading", "both"], ("components",)),
    ):
        result = call(*ENTRY.commands, arguments + more)
        assert (
            result.exit_code == 2
            and all(word in result.stderr for word in words)
            and "Traceback" not in result.output
        )
    assert not (tmp_path / "out").exists()
