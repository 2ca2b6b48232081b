"""The draws by rail modes: one number for all draws, beside the modes that each draw chooses."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.studies.montecarlo.synthetic_draws import drawn, results
from tests.studies.shown import html
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.scenes import load
from tipoff.studies.montecarlo import paired_statistics, tails_page
from tipoff.studies.populations import draws, own_modes
from tipoff.studies.populations.own_modes import OwnModes, Series
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

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
    return own_modes.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)


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
    assert [series.modes for series in found.same] == [0, 20] and found.held == 20
    for series in found.same:
        same = [rate(row, Numerics(modes=series.modes)) for row in ROWS]
        np.testing.assert_array_equal(series.results.rate, same)
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


@pytest.fixture
def untimed(monkeypatch):
    """No case runs for its time alone."""
    monkeypatch.setattr(draws, "seconds_per_case", lambda *_: 1e-3)
    return monkeypatch


def test_runs_of_the_population_are_not_made_again(study, compliance, untimed):
    """A number between none and all has a series of its own, whose runs are those beside the
    reference."""
    untimed.setattr(own_modes, "execute", lambda _: SimpleNamespace(cost={"cpu_s": 1e-3}))
    model = Surrogate(study.scene, None, compliance, 7)
    _, _, beside = draws.requests(study, model, ROWS, 1)
    assert not any(study.store.path(run).is_file() for run in beside)
    filled = own_modes.run(study, model, ROWS)
    assert [series.modes for series in filled.same] == [0, 7, 20]
    assert all(study.store.path(run).is_file() for run in beside)


def test_rails_without_modes_have_no_such_runs(study, compliance, monkeypatch):
    """Springs, and a compliance that holds none. Control: the compliance with its modes."""
    bare = replace(
        compliance, frequency=compliance.frequency[:, :0], shape=compliance.shape[..., :0]
    )
    monkeypatch.setattr(draws, "filled", lambda *_: pytest.fail("run"))
    for kept, under in ((bare, bare), (compliance, None), (compliance, compliance.rigid())):
        monkeypatch.setattr(Study, "rail_compliance", lambda *_, kept=kept, **__: kept)
        assert own_modes.run(study, Surrogate(study.scene, None, under, 0), ROWS) is None
    with pytest.raises(pytest.fail.Exception, match="run"):
        own_modes.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)


def test_the_shorter_of_two_times_counts(study, compliance, untimed):
    """The first run of each contains the loading of kernels."""
    made = []

    def execute(run):
        made.append(run.label)
        first = made.count(run.label) == 1
        return SimpleNamespace(cost={"cpu_s": 9.0 if first else 1e-3 * len(run.label)})

    untimed.setattr(own_modes, "execute", execute)
    found = own_modes.run(study, Surrogate(study.scene, None, compliance, 0), ROWS)
    labels = [f"nominal-draw{place}-compliant-own-modes" for place in range(2)]
    assert found.own.cpu_s == pytest.approx(1e-3 * len(labels[0]))
    assert [label for label in made if label in labels] == 2 * labels


def synthetic() -> OwnModes:
    """Five draws. The third to the fifth choose 2, 20 and 20 modes, which move the largest rate by
    0.1, 0.3 and 0.2 deg/s; the clearance moves it by 0.15, 0.05 and 0.6 deg/s."""
    none = np.zeros((5, 3))
    chosen = np.array([[0, 0, 0], [0, 0, 0], [0.1, 0, 0], [0, -0.3, 0.1], [0, 0, 0.2]])
    wider = np.add(chosen[2:], [[0, 0.15, 0], [0.05, 0, 0], [-0.6, 0, 0.6]])
    return OwnModes(
        held=20,
        chosen=np.array([0, 0, 2, 20, 20]),
        same=[Series(0, results(none), 2e-3), Series(20, results(none + 0.05), 9e-3)],
        own=Series("auto", results(chosen), 4e-3),
        wider=results(wider),
        clearance_change=1e-6,
    )


def test_what_the_modes_of_a_draw_change():
    """By hand, on a reference of 0.25 deg/s about y and z in the last two draws. A draw that has not
    settled counts in no median."""
    reference = np.zeros((5, 3))
    reference[3:] = [[0, -0.25, 0], [0, 0, 0.25]]
    none = drawn(reference, np.zeros((5, 3)), np.ones(5))
    found = paired_statistics.by_modes(synthetic(), none, GATE)
    assert (found.held, found.choosing, found.choosing_all) == (20, 3, 2)
    assert found.moved_deg_s == pytest.approx(0.2)
    assert found.moved_by_clearance_deg_s == pytest.approx(0.15)
    assert found.more_by_clearance == 2
    assert [row.modes for row in found.rows] == [0, 20, "auto"]
    assert [row.within_gate for row in found.rows] == pytest.approx([0.6, 0.6, 1.0])
    assert [row.most for row in found.rows] == pytest.approx([0.25, 0.3, 0.1])
    (*_, everything) = paired_statistics.by_contacts(none, GATE)
    assert vars(everything).items() - vars(found.rows[0]).items() == {("contacts", "all")}

    lost = synthetic()
    lost.own.results.rate[4] = np.nan
    found = paired_statistics.by_modes(lost, none, GATE)
    assert found.choosing == 3 and found.rows[-1].settled == 4
    assert found.moved_deg_s == pytest.approx(0.2)  # of 0.1 and 0.3
    assert found.moved_by_clearance_deg_s == pytest.approx(0.1)  # of 0.15 and 0.05


def test_what_is_said_of_them():
    reference = drawn(np.zeros((5, 3)), np.zeros((5, 3)), np.ones(5))
    own = paired_statistics.by_modes(synthetic(), reference, GATE)
    page = SimpleNamespace(own_modes=own, draws=5, modes=0, gate_deg_s=GATE)
    (said,) = tails_page.sentences_of_modes(page)
    assert said.startswith("3 of 5 draws choose rail modes for themselves, 2 of them all 20. In")
    assert all(
        f">{cell}<" in html(tails_page.by_modes(page))
        for cell in ("none, as the population", "all 20", "case by case")
    )
    page.modes = 20
    assert ">all 20, as the population<" in html(tails_page.by_modes(page))
    page.own_modes = replace(own, choosing=0)
    assert tails_page.sentences_of_modes(page) == ["none of 5 draws chooses rail modes for itself"]
    page.own_modes = None
    assert tails_page.sentences_of_modes(page) == tails_page.by_modes(page) == []
