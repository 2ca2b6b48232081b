"""A study of many cases has one number of rail modes: that of its population, in each reading, pair,
search and check, and in its result.

No case runs. In place of the kernels a case has the total rate of a free payload, three tenths larger
with modes, so that a mixture of both shows in the rates too."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, handmade
from tests.studies.limits import in_memory
from tests.studies.shown import html
from tests.validation.montecarlo.test_rungs import ran
from tipoff.lowfi.ensemble import fill, pilot, store
from tipoff.lowfi.ensemble.batch import Case
from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.outcome import Outcome
from tipoff.studies.limits import page as limits_page
from tipoff.studies.limits import stage as limits
from tipoff.studies.limits import within
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.populations import draws, population
from tipoff.studies.populations.draws import Kept
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.render import chart
from tipoff.studies.render.document import terminal
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study
from validation.montecarlo import page, rungs, tails, tails_page
from validation.montecarlo import stage as montecarlo
from validation.montecarlo.options import Cases, MontecarloOptions

WALLS = handmade(REFERENCE, {})
HELD = 5  # modes of each rail
VIBRATING = replace(
    WALLS,
    frequency=np.ones((len(WALLS.frequency), HELD)),
    shape=np.zeros((*WALLS.shape.shape[:3], HELD)),
)
MODAL = 1.3  # times the rate without modes
PER_RADIAN, PER_METRE = math.radians(20.0) / math.radians(0.2), math.radians(20.0) / 0.4e-3
OPTIONS = Cases(cases=120, limits=("8 deg/s",))
CERTIFY = LimitsOptions(("8 deg/s",), probability=0.9, cases=120, certify=20)


def rates(row, modes: int) -> list[float]:
    """rad/s, proportional to the errors of a case, in one plane of all three axes."""
    found = np.zeros(3)
    for key, slope in (
        ("thrust_offset.misalignment", PER_RADIAN),
        ("thrust_offset.eccentricity", PER_METRE),
        ("mass_offset.eccentricity", PER_METRE),
    ):
        size, angle = row.get(f"{key}.axial", 0.0), row.get(f"{key}.radial", 0.0)
        found += (
            slope * size * np.array([0.6 * math.cos(angle), math.sin(angle), 0.8 * math.cos(angle)])
        )
    return (found * (MODAL if modes else 1.0)).tolist()


def case(rate: list[float]) -> Case:
    one, three = 1.0, [1.0, 0.0, 0.0]
    outcome = Outcome(one, one, three, rate, one, one, *[three] * 6)
    return Case("exited", "", outcome, 1, 1e-3)


class Runs:
    """What ran: ``modes`` of each family of cases, of each ``single`` run, and the number of ``pilots``,
    which choose what ``choice`` says for the so-manieth pilot of an ensemble."""

    def __init__(self, *choice: int):
        self.modes: list[int] = []
        self.single: list[int] = []
        self.pilots, self.choice = 0, choice

    def solved(self, *_, **__):
        place = min(self.pilots // pilot.PILOT, len(self.choice) - 1)
        self.pilots += 1
        return SimpleNamespace(numerics={"modes": self.choice[place]})

    def completed(self, family, pieces, _workers=None):
        self.modes.append(family.numerics.modes)
        for rows in pieces:
            yield [case(rates(row, family.numerics.modes)) for row in rows]

    def filled(self, _study, _title, runs):
        self.single += [run.numerics.modes for run in runs if run.fidelity == "lowfi"]
        tables = [(run.scene.thrust_offset, run.scene.mass_offset) for run in runs]
        rows = [
            {
                "thrust_offset.misalignment.axial": thrust.misalignment.axial,
                "thrust_offset.misalignment.radial": thrust.misalignment.radial,
                "thrust_offset.eccentricity.axial": thrust.eccentricity.axial,
                "thrust_offset.eccentricity.radial": thrust.eccentricity.radial,
                "mass_offset.eccentricity.axial": mass.eccentricity.axial,
                "mass_offset.eccentricity.radial": mass.eccentricity.radial,
            }
            for thrust, mass in tables
        ]
        return [
            Kept(case(rates(row, 0)), 1, 1.0, 8, HELD if chooses(run) else 0)
            for run, row in zip(runs, rows)
        ]


def chooses(run) -> bool:
    """Whether a run chooses its modes by itself: then it takes all."""
    return run.fidelity == "lowfi" and run.numerics.modes == AUTO


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: WALLS)
    monkeypatch.setattr(draws, "announce", lambda *_: None)
    monkeypatch.setattr(chart, "to_files", lambda *_: [])  # drawing takes longer than the tests
    in_memory.keep(monkeypatch)
    return Study(REFERENCE, tmp_path, Settings(workers=1))


@pytest.fixture
def watch(monkeypatch):
    def watched(*choice: int) -> Runs:
        runs = Runs(*choice)
        monkeypatch.setattr(pilot, "solved", runs.solved)
        monkeypatch.setattr(pilot, "is_chaotic", lambda *_: False)
        for module in (fill, within, draws):
            monkeypatch.setattr(module, "completed", runs.completed)
        monkeypatch.setattr(draws, "filled", runs.filled)
        return runs

    return watched


def read(stage, study, options):
    """The result of a stage."""
    return stage.run(study, options).result


def test_one_pilot_serves_all_readings_of_a_population(study, watch):
    """Control: the second pilot would choose other modes. Nothing but the store is needed to go on."""
    runs = watch(3, 7)
    found = read(montecarlo, study, OPTIONS)
    assert runs.pilots == pilot.PILOT and found.modes == 3
    assert set(runs.modes) == {3} and len(runs.modes) == 1 + len(found.readings)
    described = [store.described(path) for path in study.folder.glob("montecarlo*-*")]
    assert len(described) == len(runs.modes)
    assert {each["identity"]["numerics"]["modes"] for each in described} == {3}
    line = "model compliant with 3 modes of each rail (enough for 16 of 16 pilot cases, whose"
    assert line in " ".join(terminal(page.summary(found)).split())
    assert "with 3 modes of each rail" in html(page.draw(found))

    study.path("montecarlo.json").unlink()
    again = read(montecarlo, study, OPTIONS)
    assert runs.pilots == pilot.PILOT and again.modes_why == found.modes_why
    assert again.quantities == found.quantities and again.readings == found.readings


def test_pairs_and_their_cost_have_the_modes_of_the_population(study, watch):
    runs = watch(3, 7)
    montecarlo.run(study, OPTIONS)
    runs.modes.clear()
    found = read(tails, study, MontecarloOptions(OPTIONS, 10))
    assert runs.pilots == pilot.PILOT, "the choice is in the store of the population"
    assert runs.single == [3] * 10 and set(runs.modes) == {3}, "pairs, and cases that are timed"
    assert found.modes == 3 and found.modes_why.startswith("3: ")
    assert "with 3 modes of each rail" in " ".join(terminal(tails_page.summary(found)).split())
    assert found.ladder is None, "these rails have none"


def test_each_draw_chooses_its_own_modes_beside_those_of_the_population(study, watch, monkeypatch):
    """Where the rails have modes. Each draw has a run that chooses, one without modes, one with those
    of the population, one with all, one with more clearance, and three with other settings."""
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: VIBRATING)
    took = {0: 1e-3, 3: 2e-3, HELD: 3e-3, AUTO: 4e-3, 4: 5e-3}
    monkeypatch.setattr(rungs, "execute", lambda run: ran(took[run.numerics.modes]))
    runs = watch(3)
    montecarlo.run(study, OPTIONS)
    found = read(tails, study, MontecarloOptions(OPTIONS, 10))
    beside, *further = (runs.single[begin : begin + 10] for begin in range(0, 90, 10))
    expected = [{AUTO}, {5}, {0}, {3}, {5}, {4}, {5}, {5}]  # the second with more clearance
    assert beside == [3] * 10 and [set(each) for each in further] == expected
    own = found.ladder
    assert (own.held, own.choosing, own.choosing_all) == (HELD, 10, 10)
    assert [row.modes for row in own.rows] == [0, 3, HELD, AUTO, 4, HELD, HELD]
    assert [row.cpu_s for row in own.rows[:4]] == pytest.approx([1e-3, 2e-3, 3e-3, 4e-3])
    assert [row.case_s is None for row in own.rows] == [False] * 3 + [True] * 4
    assert {0, 3, HELD} <= set(runs.modes), "timed"
    for shown in (tails_page.summary, tails_page.draw, tails_page.document):
        text = " ".join(html(shown(found)).split())
        assert "10 of 10 draws choose rail modes for themselves" in text
        assert "case by case" in text and "3 modes, as the population" in text


def test_no_pair_is_made_before_the_modes_are_chosen(study):
    """Control: a number, which may be none."""
    asked = Surrogate(REFERENCE, None, WALLS)
    with pytest.raises(ValueError, match="the population of the study chooses them first"):
        draws.requests(study, asked, [{}], 1)
    with pytest.raises(ValueError, match="the population of the study chooses them first"):
        draws.seconds_per_case(asked, [{}])
    _, _, (beside,) = draws.requests(study, asked._replace(modes=0), [{}], 1)
    assert beside.numerics.modes == 0


@pytest.mark.parametrize("chosen", [0, 3])
def test_the_search_its_margin_and_its_check_are_of_one_model(study, watch, monkeypatch, chosen):
    """Rates are proportional to the tolerances and to MODAL, so that the tolerances are inverse to it.
    Only the first search of the whole set has no modes; with none chosen it is the result."""
    monkeypatch.setattr(
        limits.constants,
        "margin",
        lambda *_: limits.constants.Margin(dict.fromkeys(("x", "y", "z", "total"), 1.0), "assumed"),
    )
    runs = watch(chosen)
    found = read(limits, study, CERTIFY)
    first = len(found.rows[-1].nominal.trials)
    searches = 1 if chosen == 0 else 2
    assert runs.pilots == searches * pilot.PILOT and found.modes == chosen
    assert set(runs.modes[:first]) == {0} and set(runs.modes[first:]) == {chosen}
    assert found.certificate.cases == 1200 and len(runs.modes) > 3 * first
    limit = math.radians(8.0) / (MODAL if chosen else 1.0)
    for name in ("thrust_eccentricity", "mass_eccentricity"):
        cases = within.source(REFERENCE, {name: 1.0}, 120, within.SEED).rows(0, 120)
        key = f"{within.ERRORS[name].key}.axial"
        sizes = sorted(abs(PER_METRE * drawn[key]) for drawn in cases)
        exact = limit / sizes[-1 - found.allowed]
        row = next(each for each in found.rows if each.name == name)
        assert 1.0 / 1.013 < 1e-3 * row.nominal.tolerance / exact < 1.0 + 1e-9
        assert 1.0 / 1.03 < 1e-3 * row.model.tolerance / (exact * 7.0 / 8.0) < 1.0 + 1e-9
    words = "no modes" if chosen == 0 else "3 modes"
    shown = " ".join(terminal(limits_page.draw(found)).split())
    assert f"model compliant with {words} of each rail (enough for" in shown


def test_the_search_is_repeated_until_its_own_result_needs_no_more_modes(study, watch):
    """Pilots within four results choose 2, 5, 4: the number does not fall back, or the search might
    not end."""
    runs = watch(2, 5, 4)
    found = limits.run(study, LimitsOptions(("8 deg/s",), probability=0.9, cases=120)).result
    assert runs.pilots == 3 * pilot.PILOT and found.modes == 5
    assert found.modes_why.startswith("5: ") and list(dict.fromkeys(runs.modes)) == [0, 2, 5]


def test_no_modes_chosen_is_no_modes_asked_for(study, watch):
    """The same numbers, and no word of modes where the model has none."""
    watch(0)
    rows = montecarlo.random_factors.source(REFERENCE, OPTIONS.reading, 120, 1)
    chosen, asked = (
        population.run(study, name, model, rows)
        for name, model in (
            ("chosen", Surrogate(REFERENCE, None, WALLS)),
            ("asked", Surrogate(REFERENCE, None, WALLS, 0)),
        )
    )
    for one, other in zip(chosen.results, asked.results):
        np.testing.assert_array_equal(one, other)
    assert chosen.model.modes_why and not asked.model.modes_why
    springs = population.run(study, "springs", Surrogate(REFERENCE, None, None), rows)
    found = population.Answering(**population.answering(study, springs.model))
    assert found.modes == 0 and population.model_words(found) == found.model
