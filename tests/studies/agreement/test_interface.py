"""Agreement at other values of the interface stiffness, on stubbed runs."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from tests.studies.agreement.made import ROW, context
from tests.studies.synthetic import flight
from tipoff.scenes import load
from tipoff.studies.agreement import growth, interface, page, verdicts
from tipoff.studies.render import document
from tipoff.workspace.settings import defaults
from tipoff.workspace.store import Store
from tipoff.workspace.study import Study


@pytest.fixture
def study(tmp_path):
    return Study(load("tiny"), tmp_path, defaults("tiny"))


def settle(monkeypatch, apart, grows=0.0, lost=False):
    """Runs whose rate about y rises with the stiffness, in the surrogate off by ``apart(factor)``;
    a changed clearance moves it by ``grows`` (deg/s) after the last of three contacts, or that run
    is ``lost``. Returns the labels of the runs that were asked for."""
    nominal = load("tiny").contact
    asked = []

    def motion(run):
        factor = run.scene.contact.interface_stiffness / nominal.interface_stiffness
        rate = 3.0 + 0.2 * math.log2(factor)
        rate += apart(factor) if run.fidelity == "lowfi" else 0.0
        twin = run.scene.contact.clearance != nominal.clearance
        force = np.zeros((601, 16, 3))
        for begin, end in ((60, 100), (180, 220), (300, 340)):
            force[begin:end, 0, 1] = 10.0

        def rates(t):
            later = np.select([t > 0.017, t > 0.011, t > 0.005], [1.0, 0.1, 0.01], 0.0)
            return np.outer(np.radians(rate + twin * grows * later), [0.0, 1.0, 0.0])

        status = "jammed" if lost and twin else "exited"
        return flight(rates, pad_force=force, status=status)

    def fill(store, title, runs):
        asked.extend(run.label for run in runs)
        return [motion(run) for run in runs]

    monkeypatch.setattr(Store, "fill", fill)
    return asked


def rows(study, uncertainty=0.01, known=True):
    def request(study, name, overrides, tag):
        return study.lowfi(name, None, overrides, tag)

    return interface.rows(study, request, context(uncertainty, known))


def test_both_models_move_and_agree_at_every_factor(study, monkeypatch):
    """The reference moves by 0.4 deg/s either way, four times its limit of convergence: that is no
    part of its uncertainty. No twin is run where the models agree."""
    asked = settle(monkeypatch, lambda factor: 0.01)
    found = rows(study)
    assert [(row.factor, row.verdict) for row in found] == [
        (0.25, "agrees"),
        (1.0, "agrees"),
        (4.0, "agrees"),
    ]
    assert [row.reference_change_deg_s for row in found] == pytest.approx([0.4, 0.0, 0.4])
    assert not any("clearance" in label for label in asked)
    (whole,) = interface.combined([ROW], found)
    assert whole.judgement == whole.verdict == "agrees"


def test_a_miss_at_one_factor_is_a_miss_of_the_condition(study, monkeypatch):
    """Control: where the reference is not converged, no factor is run."""
    asked = settle(monkeypatch, lambda factor: 0.3 * (factor == 4.0))
    found = rows(study)
    assert [row.judgement for row in found] == ["agrees", "agrees", "misses"]
    assert "misses: " in found[2].verdict
    assert [row.growth for row in found] == [None, None, growth.STABLE]
    assert sum("clearance" in label for label in asked) == 2
    (whole,) = interface.combined([ROW], found)
    assert whole.verdict == "misses: at 4 times the interface stiffness"
    assert whole.judgement == verdicts.MISSES
    asked.clear()
    unknown = rows(study, uncertainty=0.2)
    assert unknown == [] == asked
    (same,) = interface.combined([ROW], unknown)
    assert same.judgement == "agrees"


def test_a_chaotic_reference_is_not_judged(study, monkeypatch):
    """1 um of clearance grows a hundredfold over three contacts. Control: above, where it does not
    grow, the same difference is a miss."""
    settle(monkeypatch, lambda factor: 0.3 * (factor == 4.0), grows=5.0)
    found = rows(study)
    assert [row.verdict for row in found[:2]] == ["agrees", "agrees"]
    assert found[2].judgement == verdicts.CANNOT and found[2].growth == growth.CHAOTIC
    assert found[2].verdict.startswith("cannot be judged: reference chaotic (rate L2 ")
    assert page.stiffnesses(found).endswith("none is judged at 4 times")
    (whole,) = interface.combined([ROW], found)
    assert whole.judgement == "agrees"


def test_a_miss_where_growth_is_not_known_is_neither_agreement_nor_a_miss(study, monkeypatch):
    """A run with another clearance does not settle, so nobody knows whether chaos is the cause.
    Control: above, where it settles and does not grow, the same difference is a miss. A miss at another
    factor decides alone."""
    settle(monkeypatch, lambda factor: 0.3 * (factor == 4.0), lost=True)
    found = rows(study)
    assert [row.growth for row in found] == [None, None, growth.UNKNOWN]
    assert found[2].judgement == verdicts.CANNOT
    assert found[2].verdict.startswith(
        "cannot be judged: growth of 1 µm in the reference not known (rate L2 "
    )
    assert page.stiffnesses(found).endswith("none is judged at 4 times")
    (whole,) = interface.combined([ROW], found)
    assert (whole.judgement, whole.verdict) == (
        verdicts.CANNOT,
        "cannot be judged: growth of 1 µm in the reference not known at 4 times the interface "
        "stiffness",
    )
    missed = replace(found[0], judgement=verdicts.MISSES, growth=growth.STABLE)
    (whole,) = interface.combined([ROW], [missed, *found[1:]])
    assert whole.verdict == "misses: at 0.25 times the interface stiffness"


def test_a_reference_whose_convergence_is_not_known_is_judged_at_no_factor(study, monkeypatch):
    """A mesh could not be refined. Control: above, a known one is judged at each. No twin is run."""
    asked = settle(monkeypatch, lambda factor: 0.3)
    found = rows(study, known=False)
    assert {row.verdict for row in found} == {verdicts.NOT_KNOWN}
    assert {row.judgement for row in found} == {verdicts.CANNOT}
    assert not any("clearance" in label for label in asked)


def test_a_condition_that_is_chaotic_at_the_nominal_stiffness_is_named(study, monkeypatch):
    """It is judged as a distribution, and so is one of which that is not known. Control: without growth
    the miss is one of a curve."""
    for grows, lost, names in ((5.0, False, ["phi15"]), (0.0, True, ["phi15"]), (0.0, False, [])):
        settle(monkeypatch, lambda factor: 0.3, grows=grows, lost=lost)
        assert interface.undecided(rows(study)) == names


def test_verdicts_are_on_the_page_in_markdown_and_in_the_terminal(study, monkeypatch):
    settle(monkeypatch, lambda factor: 0.3 * (factor == 4.0))
    found = rows(study)
    words = (
        "1 of 1 judged conditions agree at 0.25 times, 1 of 1 judged conditions agree at 1 times"
    )
    for text in (
        document.markdown(page.at_factors(found)),
        document.terminal(page.at_factors(found)),
    ):
        assert words in " ".join(text.split()) and "misses: " in text and "phi15" in text
    assert page.at_factors([]) == []


def test_a_scene_without_contact_has_no_interface(study):
    free = Study(study.scene.replace({"contact": None}), study.folder, study.settings)
    assert interface.rows(free, partial(pytest.fail), context()) == []
