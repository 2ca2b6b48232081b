"""Conditions that are judged as distributions: which ones, by how many runs, and with which verdict, on
stubbed runs of the reference."""

import json
from dataclasses import asdict, dataclass, replace

import numpy as np
import pytest
from scipy.stats.mstats import hdquantiles

from tests.studies.agreement.made import ROW
from tests.studies.synthetic import flight
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.scenes import load
from tipoff.studies.agreement import distribution_page, distributions, growth, interface, verdicts
from tipoff.studies.agreement.candidates import Candidate
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.render import document
from tipoff.workspace.settings import defaults
from tipoff.workspace.store import Store
from tipoff.workspace.study import Study
from validation.documents import further

LIMIT = 0.1  # deg/s


@pytest.fixture
def study(tmp_path):
    return Study(load("tiny"), tmp_path, defaults("tiny"))


def rate_of(scene, offset=0.0, gain=2e6):
    """A rate that the position at ignition moves by 2 deg/s per um."""
    shift = scene.initial.position.y if scene.initial else 0.0
    return [gain * shift + offset, 0.0, 3.0]


@dataclass
class Cases:
    """Settled rates as the ensemble gives them."""

    values: np.ndarray

    def __getitem__(self, name):
        return self


def stub(monkeypatch, offset, lost=()):
    """The reference and a surrogate whose rates differ by ``offset``; neighbours ``lost`` of the
    reference do not settle. Returns the labels of the runs that were asked for."""
    asked = []

    def fill(store, title, runs):
        asked.extend(run.label for run in runs)
        return [
            flight(status="jammed")
            if number in lost
            else flight(lambda t, run=run: np.tile(np.radians(rate_of(run.scene)), (t.size, 1)))
            for number, run in enumerate(runs)
        ]

    def run_many(scene, rows, model, **_):
        values = [rate_of(scene.replace(row), offset) for row in rows[:36]]
        rest = np.random.default_rng(1).uniform(-2.0, 2.0, len(rows) - len(values))
        values += [[value + offset, 0.0, 3.0] for value in rest]
        return Cases(np.radians(values))

    monkeypatch.setattr(Store, "fill", fill)
    monkeypatch.setattr(distributions.lowfi, "run_many", run_many)
    return asked


def judged(study, count=36):
    springs = Candidate("calibrated", "springs, calibrated")
    (found,) = distributions.judge(study, {"phi15": count}, [springs], LIMIT)
    return found


def compared(found):
    """With the verdict on the springs for compliant contact too."""
    springs = found.models["calibrated"]
    return replace(found, models={"calibrated": springs, "compliant": springs})


def row(condition, converged=True, judgement=verdicts.AGREES):
    return replace(
        ROW,
        condition=condition,
        reference_converged=converged,
        judgement=judgement,
        verdict=judgement,
    )


def grown(condition, sensitive, model=FINITE_ELEMENTS):
    found = growth.growth("c", model, flight(), [flight()], 1e-6, LIMIT)
    return replace(found, condition=condition, sensitive=sensitive)


def test_only_conditions_that_no_single_run_can_judge_have_neighbours():
    """Sensitive ones have all draws, others a quarter. Controls: a surrogate that is sensitive, and a
    reference that is converged and stable, which is judged as a curve."""
    rows = [row("a"), row("b", converged=False), row("c"), row("d"), row("e"), row("f")]
    growths = [
        grown("a", False),
        grown("b", False),
        grown("c", True),
        grown("d", None),
        grown("f", True, "compliant"),
    ]
    wanted = distributions.counts(rows, growths, ["e"], 32)
    assert wanted == {"b": 8, "c": 32, "d": 32, "e": 32}


def test_a_surrogate_agrees_as_a_distribution_where_1_um_moves_more_than_the_limit(
    study, monkeypatch
):
    """Rates within +-2 deg/s, and a surrogate that is off by four times the limit of single runs.
    Control: off by twice the margin, a quarter of the distance 3.2 deg/s of the quantiles."""
    asked = stub(monkeypatch, 0.4)
    found = judged(study)
    assert asked == [f"phi15-neighbour-{number}-coarse" for number in range(36)]
    own = found.models["calibrated"]
    assert (own.judgement, own.verdict) == ("agrees as distribution",) * 2
    first = own.comparisons[0]
    assert first.margin_deg_s == pytest.approx(0.8, rel=0.2)
    assert first.difference_deg_s == pytest.approx(0.4, abs=0.05)
    stub(monkeypatch, 1.6)
    far = judged(study).models["calibrated"]
    assert far.judgement == "misses" and far.verdict.startswith("misses: ")
    assert far.verdict.endswith(" x margin") and "rate x" in far.verdict


def test_chaos_does_not_explain_a_surrogate_beyond_the_neighbours_of_the_reference(
    study, monkeypatch
):
    """The quantiles of the reference are 3.2 deg/s apart. Control: 1.6 deg/s, above, has no such words."""
    stub(monkeypatch, 4.0)
    words = judged(study).models["calibrated"].verdict
    assert words.startswith("misses: ")
    assert "a miss of the model, not chaos: the median of rate x differs by 4 deg/s" in words


def test_too_few_neighbours_cannot_judge_and_say_how_many_can(study, monkeypatch):
    """The same pair in another order, so that it is no pair. Control: above, pair by pair."""
    stub(monkeypatch, 0.0)
    settled = distributions.lowfi.run_many
    monkeypatch.setattr(
        distributions.lowfi,
        "run_many",
        lambda scene, rows, model, **options: settled(scene, [*rows[5::-1], *rows[6:]], model),
    )
    found = judged(study, 6).models["calibrated"]
    assert found.judgement == "cannot be judged"
    assert "with 6 neighbours the" in found.verdict and "are needed" in found.verdict


def test_neighbours_that_do_not_settle(study, monkeypatch):
    """In the reference they forbid a claim, in the surrogate alone they are a miss."""
    stub(monkeypatch, 0.0, lost=(3,))
    own = judged(study)
    # a missing number is None in the file, and the range is that of the others
    kept = json.loads(json.dumps(asdict(own), allow_nan=False))["reference_deg_s"]
    assert kept.count(None) == 1 and kept[3] is None and len(own.settled_deg_s) == 35
    assert document.markdown(distribution_page.parts([compared(own)], 1e-6))
    found = own.models["calibrated"]
    assert found.verdict == ("cannot be judged: 1 of 36 neighbours did not settle in the reference")
    stub(monkeypatch, float("nan"))
    found = judged(study).models["calibrated"]
    assert found.verdict == "misses: 36 of 36 neighbours did not settle"


def test_verdicts_go_into_the_table(study, monkeypatch):
    """Control: a condition that was not asked for stays as it is. One without neighbours cannot be
    judged."""
    stub(monkeypatch, 0.4)
    found = [judged(study)]
    rows = [row("phi15", False, verdicts.CANNOT), row("h1"), row("h2", False, verdicts.CANNOT)]
    combined = distributions.combined(rows, found, ["phi15", "h2"], "calibrated")
    assert [item.judgement for item in combined] == [
        "agrees as distribution",
        "agrees",
        "cannot be judged",
    ]
    assert [item.judged_as for item in combined] == ["distribution", "curve", "distribution"]
    assert combined[2].verdict == "cannot be judged: no clearance for neighbours"


def test_a_miss_at_another_stiffness_is_a_miss_of_a_distribution_too():
    """Control: at the nominal stiffness the distribution has judged."""
    agreeing = row("phi15", judgement=verdicts.AS_DISTRIBUTION)
    for factor, expected in ((4.0, verdicts.MISSES), (1.0, verdicts.AS_DISTRIBUTION)):
        item = interface.AtStiffness(
            condition="phi15",
            factor=factor,
            interface_stiffness_n_m3=1e12,
            reference_change_deg_s=0.0,
            surrogate_change_deg_s=0.0,
            rate_relative_l2=0.1,
            velocity_relative_l2=0.0,
            settled_rate_error_deg_s=0.0,
            growth=growth.STABLE,
            judgement=verdicts.MISSES,
            verdict="misses: rate L2 2 x limit",
        )
        (found,) = interface.combined([agreeing], [item])
        assert found.judgement == expected


def test_a_clearance_below_the_neighbours_has_none(tmp_path):
    tight = load("tiny").replace({"contact.clearance": "3 um"})
    study = Study(tight, tmp_path, defaults("tiny"))
    assert distributions.judge(study, {"phi15": 8}, [], LIMIT) == []


def test_the_cost_is_announced_before_it_is_paid(study, monkeypatch, capsys):
    """Control: nothing is said where every run is stored."""
    stub(monkeypatch, 0.0)
    judged(study, 5)
    said = capsys.readouterr().err
    assert "5 of 5 runs of the reference on elements of 16 mm are to be made" in said
    assert "on one core" in said and "GB for each of" in said
    monkeypatch.setattr(Store, "path", lambda store, run: study.folder)
    monkeypatch.setattr("pathlib.Path.is_file", lambda path: True)
    judged(study, 5)
    assert "runs of the reference" not in capsys.readouterr().err


def test_figure(study, monkeypatch):
    """The distribution of the reference rises from 0 to 1 in steps of 1/36 at its values."""
    stub(monkeypatch, 0.4)
    found = [compared(judged(study))]
    assert distribution_page.parts([], 1e-6) == further.distributions([]) == []
    assert "Springs are the control" in document.markdown(further.distributions(found))
    chart = distribution_page.picture(distribution_page.most_spread(found))
    assert "settled rate" in chart.panels[0].x_label
    reference, _, drawn = chart.panels[0].lines
    assert (min(reference.y), max(reference.y), len(reference.y)) == (0.0, 1.0, 72)
    assert np.all(np.diff(reference.x) >= 0.0) and np.all(np.diff(reference.y) >= 0.0)
    middle = np.interp(0.5, drawn.y, drawn.x)
    assert middle == pytest.approx(0.4, abs=0.2)


def test_the_table_of_a_tutorial_has_the_quantiles_of_both_models(study, monkeypatch):
    """Each surrogate is a row below the reference. Control: launches that do not settle have no quantiles."""
    stub(monkeypatch, 0.4)
    found = compared(judged(study))
    reference, *others = further.quantiles([found]).rows
    assert len(others) == len(found.models)
    for place in range(3):
        rates = [rates[place] for rates in found.settled_deg_s]
        values = [float(each) for each in reference[2 + place].split(", ")]
        assert values == pytest.approx(np.ravel(hdquantiles(rates, [0.1, 0.5, 0.9])), abs=0.051)
    stub(monkeypatch, 0.4, lost=(3,))
    reference, *others = further.quantiles([compared(judged(study))]).rows
    assert set(reference[2:5]) == {""} and verdicts.CANNOT in others[0]


@pytest.mark.slow
def test_control_calibrated_springs_miss_where_compliant_contact_agrees(study):
    """Real runs of the reference on elements of 16 mm. Nothing is fitted on compliant contact; the
    springs are fitted to this very condition."""
    springs = Candidate("calibrated", "springs, calibrated", calibrate.load(study))
    compliance = study.rail_compliances(["phi15"], study.settings.coarse_size)
    compliant = Candidate("compliant", "compliant", compliance=compliance)
    (found,) = distributions.judge(study, {"phi15": 8}, [springs, compliant], LIMIT)
    words = {name: item.judgement for name, item in found.models.items()}
    assert words == {"calibrated": "misses", "compliant": "agrees as distribution"}
