"""The draws by settings of the surrogate: one number of modes for all draws, the modes that each draw
chooses, springs, and more patterns."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.studies.shown import html
from tests.validation.montecarlo.synthetic_draws import drawn, results
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.scenes import load
from tipoff.studies.populations import draws
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study
from validation.bench.done import NotDone
from validation.montecarlo import ladder_page, paired_statistics, rungs
from validation.montecarlo.rungs import OTHERS, Rung, Rungs

# modes that do not matter, and one that does
ROWS = [{"thrust_offset.misalignment.radial": math.radians(angle)} for angle in (45.0, 15.0)]
GATE = 0.1  # deg/s


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """The coarse mesh has elements of 8 mm."""
    return Study(
        load("tiny"), tmp_path_factory.mktemp("out"), Settings(element_size=0.004, workers=1)
    )


@pytest.fixture(scope="module")
def compliance(study):
    return study.rail_compliance(study.scene, element_size=study.settings.coarse_size)


@pytest.fixture(scope="module")
def found(study, compliance):
    return rungs.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)


@pytest.fixture(scope="module")
def rate(study, compliance):
    """Settled rate of a single run."""

    def single(row, numerics: Numerics | None = None):
        asked = study.scene.replace(row)
        return lowfi.run(asked, compliance=compliance, numerics=numerics).outcome.rate

    return single


def test_draws_choose_as_single_runs(study, compliance, found, rate):
    """The rates of a single run of the scene of each draw, to the last bit. Control: the draw that
    chooses some modes has other rates without."""
    assert found.chosen.tolist() == [
        lowfi.run(study.scene.replace(row), compliance=compliance).numerics["modes"] for row in ROWS
    ]
    np.testing.assert_array_equal(found.own.results.rate, [rate(row) for row in ROWS])
    assert [rung.numerics.modes for rung in found.same] == [0, 20] and found.held == 20
    for rung in found.same:
        same = [rate(row, Numerics(modes=rung.numerics.modes)) for row in ROWS]
        np.testing.assert_array_equal(rung.results.rate, same)
    apart = np.abs(found.own.results.rate - found.same[0].results.rate).max(axis=1)
    assert apart[0] == found.chosen[0] == 0 and found.chosen[1] > 0 and apart[1] > 1e-5


def test_more_clearance_keeps_the_modes_of_the_draw(study, found, rate):
    """Of the draws that choose some. Control: the clearance of the scene."""
    own, given = study.scene.contact.clearance, Numerics(modes=int(found.chosen[1]))
    wider, same = (
        rate(ROWS[1] | {"contact.clearance": own + change}, given) for change in (1e-6, 0.0)
    )
    np.testing.assert_array_equal(found.wider.rate, [wider])
    assert np.abs(np.subtract(wider, same)).max() > 1e-6


def ran(cpu_s: float, status: str = "exited") -> SimpleNamespace:
    """A run of this time."""
    return SimpleNamespace(status=status, message="", cost={"cpu_s": cpu_s, "steps": 1})


@pytest.fixture
def untimed(monkeypatch):
    """No case runs for its time alone."""
    monkeypatch.setattr(draws, "seconds_per_case", lambda *_: 1e-3)
    return monkeypatch


def test_runs_of_the_population_are_not_made_again(study, compliance, untimed):
    """A number between none and all has a series of its own, whose runs are those beside the
    reference."""
    untimed.setattr(rungs, "execute", lambda _: ran(1e-3))
    model = Surrogate(study.scene, None, compliance, 7)
    _, _, beside = draws.requests(study, model, ROWS, 1)
    assert not any(study.store.path(run).is_file() for run in beside)
    filled = rungs.run(study, model, ROWS)
    assert [rung.numerics.modes for rung in filled.same] == [0, 7, 20]
    assert all(study.store.path(run).is_file() for run in beside)


def test_rails_without_modes_have_no_such_runs(study, compliance, monkeypatch):
    """Springs, and a compliance that holds none. Control: the compliance with its modes."""
    bare = replace(
        compliance, frequency=compliance.frequency[:, :0], shape=compliance.shape[..., :0]
    )
    monkeypatch.setattr(draws, "filled", lambda *_: pytest.fail("run"))
    for kept, under in ((bare, bare), (compliance, None), (compliance, compliance.rigid())):
        monkeypatch.setattr(Study, "rail_compliance", lambda *_, kept=kept, **__: kept)
        assert rungs.run(study, Surrogate(study.scene, None, under, 0), ROWS) is None
    with pytest.raises(pytest.fail.Exception, match="run"):
        rungs.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)


def test_the_shorter_of_two_times_counts(study, compliance, untimed):
    """The first run of each contains the loading of kernels."""
    made = []

    def execute(run):
        made.append(run.label)
        first = made.count(run.label) == 1
        return ran(9.0 if first else 1e-3 * len(run.label))

    untimed.setattr(rungs, "execute", execute)
    found = rungs.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)
    labels = [f"nominal-draw{place}-compliant-own-modes" for place in range(2)]
    assert found.own.cpu_s == pytest.approx(1e-3 * len(labels[0]))
    assert [label for label in made if label in labels] == 2 * labels


def test_a_failed_run_has_no_time(study, compliance, untimed):
    """Its time would be too short. Control: no other run is left."""
    times = {"draw0": ran(1e-6, "diverged"), "draw1": ran(2e-3)}
    untimed.setattr(rungs, "execute", lambda run: times[run.label.split("-")[1]])
    found = rungs.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)
    assert found.own.cpu_s == pytest.approx(2e-3)
    times["draw1"] = times["draw0"]
    with pytest.raises(NotDone, match="none of 2 runs"):
        rungs.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)


def test_other_settings_have_the_rates_of_single_runs(study, found, rate):
    """On the compliance of the degree that they need. Control: the default settings."""
    assert tuple(rung.numerics for rung in found.others) == OTHERS, "not calibrated"
    for rung in found.others:
        size, degree = study.settings.coarse_size, rung.numerics.needed_degree
        under = study.rail_compliance(study.scene, element_size=size, degree=degree)
        finer = [
            lowfi.run(study.scene.replace(row), compliance=under, numerics=rung.numerics)
            for row in ROWS
        ]
        np.testing.assert_array_equal(rung.results.rate, [each.outcome.rate for each in finer])
        assert np.abs(rung.results.rate - [rate(row) for row in ROWS]).max() > 1e-5


def test_springs_are_a_rung_of_a_calibrated_study(study, compliance, untimed):
    """On the constants of the calibration."""
    untimed.setattr(rungs, "execute", lambda _: ran(1e-3))
    untimed.setattr(rungs.calibrate, "stored", lambda _: {"key": "of this scene"})
    untimed.setattr(
        rungs.population, "surrogate", lambda study, name: Surrogate(study.scene, None, None)
    )
    springs, *_ = rungs.run(study, Surrogate(study.scene, None, compliance, 0), ROWS).others
    assert springs.model == "springs"
    rates = [lowfi.run(study.scene.replace(row), "springs").outcome.rate for row in ROWS]
    np.testing.assert_array_equal(springs.results.rate, rates)


def synthetic() -> Rungs:
    """Five draws. The third to the fifth choose 2, 20 and 20 modes, which move the largest rate by
    0.1, 0.3 and 0.2 deg/s; the clearance moves it by 0.15, 0.05 and 0.6 deg/s."""
    none = np.zeros((5, 3))
    chosen = np.array([[0, 0, 0], [0, 0, 0], [0.1, 0, 0], [0, -0.3, 0.1], [0, 0, 0.2]])
    wider = np.add(chosen[2:], [[0, 0.15, 0], [0.05, 0, 0], [-0.6, 0, 0.6]])
    return Rungs(
        held=20,
        chosen=np.array([0, 0, 2, 20, 20]),
        same=[
            Rung("compliant", Numerics(modes=0), results(none), 2e-3),
            Rung("compliant", Numerics(modes=20), results(none + 0.05), 9e-3),
        ],
        own=Rung("compliant", Numerics(), results(chosen), 4e-3),
        others=[
            Rung("springs", Numerics(modes=0), results(none + 1.0), 1e-3),
            Rung("compliant", OTHERS[-1], results(none), 9e-2),
        ],
        wider=results(wider),
        clearance_change=1e-6,
    )


def test_what_the_modes_of_a_draw_change():
    """By hand, on a reference of 0.25 deg/s about y and z in the last two draws. A draw that has not
    settled counts in no median."""
    reference = np.zeros((5, 3))
    reference[3:] = [[0, -0.25, 0], [0, 0, 0.25]]
    none = drawn(reference, np.zeros((5, 3)), np.ones(5))
    found = paired_statistics.ladder(synthetic(), none, GATE)
    assert (found.held, found.choosing, found.choosing_all) == (20, 3, 2)
    assert found.moved_deg_s == pytest.approx(0.2)
    assert found.moved_by_clearance_deg_s == pytest.approx(0.15)
    assert found.more_by_clearance == 2
    assert [row.modes for row in found.rows] == [0, 20, "auto", 0, 20]
    assert [row.within_gate for row in found.rows] == pytest.approx([0.6, 0.6, 1.0, 0.0, 0.6])
    assert [row.most for row in found.rows] == pytest.approx([0.25, 0.3, 0.1, 1.25, 0.25])
    (*_, everything) = paired_statistics.by_contacts(none, GATE)
    assert vars(everything).items() - vars(found.rows[0]).items() == {("contacts", "all")}

    lost = synthetic()
    lost.own.results.rate[4] = np.nan
    found = paired_statistics.ladder(lost, none, GATE)
    assert found.choosing == 3 and found.rows[2].settled == 4
    assert found.moved_deg_s == pytest.approx(0.2)  # of 0.1 and 0.3
    assert found.moved_by_clearance_deg_s == pytest.approx(0.1)  # of 0.15 and 0.05


def test_what_is_said_of_them():
    reference = drawn(np.full((5, 3), 0.02), np.zeros((5, 3)), np.ones(5))
    ladder = paired_statistics.ladder(synthetic(), reference, GATE)
    page = SimpleNamespace(
        ladder=ladder,
        draws=5,
        paired=5,
        modes=0,
        gate_deg_s=GATE,
        errors=[],
        fine=2,
        element_size_m=0.004,
        fine_element_size_m=0.002,
        cost=SimpleNamespace(reference_cpu_s=1.6),
    )
    (said,) = ladder_page.sentences(page)
    assert said.startswith("3 of 5 draws choose rail modes for themselves, 2 of them all 20. In")
    cells = ("no modes, as the population", "all 20 modes", "modes case by case")
    cells = (*cells, "calibrated springs", "degree 4, all 20 modes")
    assert all(f">{cell}<" in html(ladder_page.table(page)) for cell in cells)
    page.modes = 20
    assert ">all 20 modes, as the population<" in html(ladder_page.table(page))
    (drawing,) = ladder_page.figures(page)
    above, middle, *names = drawing.chart.panels[0].lines
    assert [name.labels for name in names[-2:]] == [
        ("calibrated springs",),
        ("degree 4, all 20 modes",),
    ]
    np.testing.assert_allclose(middle.x, [2e-3, 9e-3, 4e-3, 1e-3, 9e-2])
    np.testing.assert_allclose(middle.y, [0.02, 0.03, 0.08, 0.98, 0.02])
    assert (np.asarray(above.y) >= middle.y).all()
    page.ladder = replace(ladder, choosing=0)
    assert ladder_page.sentences(page) == ["none of 5 draws chooses rail modes for itself"]
    page.ladder = None
    assert not [*ladder_page.sentences(page), *ladder_page.table(page), *ladder_page.figures(page)]
    assert ladder_page.best(page) == []
