"""Rows of the agreement table: gates, floor, and a reference that is not converged."""

from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest

from tests.studies.agreement.made import ROW
from tests.studies.synthetic import flight
from tipoff import highfi, lowfi
from tipoff.comparison import metrics
from tipoff.scenes import load
from tipoff.studies.agreement import page, refinement, verdicts
from tipoff.studies.agreement.verdicts import Context, Refinement, Spread
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study


def constant(*rate, **parts):
    """A run whose rates are constant (deg/s)."""
    return flight(lambda t: np.tile(np.radians(rate), (t.size, 1)), **parts)


def refined(cause, uncertainty):
    return Refinement(
        condition="phi15",
        model="reference",
        cause=cause,
        sizes=[4.0, 2.0],
        rate_relative_l2=0.001,
        settled_rate_change_deg_s=0.01,
        uncertainty_deg_s=uncertainty,
        order=1.0,
        method="GCI",
    )


CONVERGED = [refined("mesh", 0.02), refined("cells", 0.05)]
FLOORS = [
    Spread("phi15", "reference", "clearance", 0.004, 0.01),
    Spread("phi15", "surrogate", "clearance", 0.003, 0.03),
    Spread("phi60", "reference", "clearance", 0.006, 0.02),
]
GATES = verdicts.gates(load("reference"))


def row(other, refinements=CONVERGED, condition="phi15"):
    touched = constant(3.0, 0.0, 4.0, pad_force=np.ones((601, 16, 3)))
    return verdicts.row(condition, "held_out", touched, other, Context(FLOORS, refinements, GATES))


def test_agreement_within_all_gates():
    found = row(constant(3.0, 0.05, 4.0))
    assert found.verdict == found.judgement == "agrees"
    assert found.judged_as == "curve"
    assert found.rate_relative_l2 == pytest.approx(0.01, rel=1e-9)
    assert found.settled_rate_error_deg_s == pytest.approx(0.05, rel=1e-9)


def test_agreement_in_free_flight_says_that_nothing_was_tested():
    found = verdicts.row(
        "phi15",
        "fitted",
        constant(3.0, 0.0, 4.0),
        constant(3.0, 0.0, 4.0),
        Context(FLOORS, CONVERGED, GATES),
    )
    assert not found.touches and found.verdict == "agrees (no pad touches)"


def test_missed_gate_says_by_how_much():
    found = row(constant(3.0, 0.0, 4.4))
    assert found.gates["settled_rate_error_deg_s"].times_limit == pytest.approx(4.0, rel=1e-9)
    assert found.verdict == "misses: rate L2 1.6 x limit, settled rate 4 x limit"
    assert found.judgement == "misses"


def test_gates_are_those_of_the_scene_or_twice_the_floor():
    assert astuple(GATES) == pytest.approx((0.05, 0.001, 0.1))
    harder = verdicts.gates(load("sensitive"))
    assert (harder.rate_relative_l2, harder.settled_rate_error_deg_s) == pytest.approx((0.1, 0.2))
    limits = [
        Context([], [], GATES).limits(floor).settled_rate_error_deg_s
        for floor in (None, 0.03, 0.08, 3.0)
    ]
    # a chaotic condition does not forgive everything
    assert limits == pytest.approx([0.1, 0.1, 0.16, 0.2])


def test_reference_that_is_not_converged_forbids_any_claim():
    found = row(constant(3.0, 0.0, 4.0), [refined("mesh", 0.18)])
    assert found.verdict == "cannot be judged: reference not converged"
    assert found.reference_uncertainty_deg_s == 0.18
    assert found.judgement == verdicts.CANNOT
    assert row(constant(3.0, 0.0, 4.0), []).verdict == verdicts.NOT_KNOWN


@pytest.mark.parametrize("steps", [[None], [0.01, None]])
def test_borrowed_uncertainties_that_are_not_known_stay_unknown(steps):
    """h1 has its own refinement by the mesh and borrows the one by the step, which did not settle.
    Controls: a known one is borrowed, and the largest of several counts."""
    own = replace(refined("mesh", 0.02), condition="h1")

    def judged(*found):
        borrowed = [refined("step", value) for value in found]
        return row(constant(3.0, 0.0, 4.0), [own, *borrowed], "h1")

    found = judged(*steps)
    assert found.reference_uncertainty_deg_s is None and not found.reference_converged
    assert found.judgement == verdicts.CANNOT
    assert not found.reference_uncertainty_measured_here
    known = judged(0.01, 0.03)
    assert known.reference_uncertainty_deg_s == 0.03 and known.judgement == verdicts.AGREES


def test_floor_is_the_own_one_where_measured_else_the_largest():
    own, other = row(constant(3.0, 0.0, 4.0)), row(constant(3.0, 0.0, 4.0), condition="h1")
    assert (own.floor_deg_s, own.floor_l2, own.floor_measured_here) == (0.03, 0.004, True)
    assert (other.floor_deg_s, other.floor_l2, other.floor_measured_here) == (
        0.03,
        0.006,
        False,
    )
    assert own.reference_uncertainty_by_cause_deg_s == {"mesh": 0.02, "cells": 0.05}


def test_run_that_did_not_settle_never_passes():
    found = verdicts.row(
        "phi15",
        "fitted",
        constant(3.0, 0.0, 4.0),
        flight(status="jammed"),
        Context(FLOORS, CONVERGED, GATES),
    )
    assert found.judgement == verdicts.MISSES
    assert "settled rate unknown" in found.verdict


def test_spread_takes_the_larger_side():
    found = verdicts.spread(
        "phi15",
        "reference",
        "clearance",
        constant(1.0, 0.0, 0.0),
        [constant(1.02, 0.0, 0.0), constant(0.99, 0.0, 0.0)],
    )
    assert found.settled_rate_change_deg_s == pytest.approx(0.02, rel=1e-9)
    assert found.rate_relative_l2 == pytest.approx(0.02, rel=1e-9)


def test_every_condition_of_the_reference_has_an_uncertainty_of_its_own(monkeypatch):
    """By mesh, step and cells, and not by the interface stiffness. Control: where a scene refines one
    only, the others borrow, and say so."""
    scene = load("reference")
    for refined, expected in (
        (scene.agreement.refined, set(scene.conditions)),
        (["phi35"], {"phi35"}),
    ):
        study = Study(
            scene.replace({"agreement.refined": list(refined)}), Path("nowhere"), Settings()
        )
        monkeypatch.setattr(
            type(study.store), "fill", lambda store, title, runs: [flight() for _ in runs]
        )
        context = Context([], refinement.refinements(study), GATES)
        assert {name for name in study.conditions if context.uncertainty(name)[2]} == expected
        assert list(context.uncertainty("h4")[1]) == ["mesh", "step", "cells"]


def test_step_and_cells_are_refined_where_the_mesh_alone_is_converged(monkeypatch):
    """Rates that change by 0.5 deg/s with the mesh, and by nothing else: no single run can judge the
    condition. Control: another one, whose mesh changes nothing, has all three causes."""
    scene = load("reference").replace({"agreement.refined": ["phi35", "h7"]})
    study = Study(scene, Path("nowhere"), Settings(), ("phi35", "h7"))
    sizes = set()

    def rates(run):
        sizes.add(run.numerics.element_size)
        coarse = run.numerics.element_size == study.settings.coarse_size
        moved = np.radians(0.5) if run.label.startswith("h7") and coarse else 0.0
        return flight(lambda t: np.outer(np.full(t.size, moved), [0.0, 1.0, 0.0]))

    monkeypatch.setattr(type(study.store), "fill", lambda store, title, runs: map(rates, runs))
    found = refinement.refinements(study)
    assert len(sizes) > 1
    assert [(item.condition, item.cause) for item in found] == [
        ("phi35", "mesh"),
        ("h7", "mesh"),
        ("phi35", "step"),
        ("phi35", "cells"),
    ]
    context = Context([], found, GATES)
    assert context.converged("phi35") and not context.converged("h7")


@pytest.fixture(scope="module")
def coarse_walls():
    return highfi.condense(load("reference"), 4e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["phi35", "h2"])
def test_compliant_walls_agree_with_finite_elements_on_the_same_mesh(coarse_walls, name):
    """Nothing is fitted: well inside the gates of the scene, 5 % and 0.1 deg/s, where pads touch.
    Both stand on elements of 4 mm, so the mesh is no part of the difference. Control: on rigid
    springs with the scene's own constants the gates are missed."""
    scene = load("reference").condition(name)
    reference = highfi.run(scene, highfi.Numerics(element_size=4e-3))
    assert reference.status == "exited" and reference.pad_force.any()
    found = metrics.compare(reference, lowfi.run(scene, compliance=coarse_walls))
    assert found.rate_relative_l2 < 0.02 and found.settled_rate_error_deg_s < 0.05
    assert found.velocity_relative_l2 < GATES.velocity_relative_l2
    springs = metrics.compare(reference, lowfi.run(scene, "springs"))
    assert springs.rate_relative_l2 > GATES.rate_relative_l2
    assert springs.settled_rate_error_deg_s > GATES.settled_rate_error_deg_s


def test_conditions_are_counted_by_their_word():
    words = [verdicts.AGREES] * 3 + [verdicts.AS_DISTRIBUTION] * 2 + [verdicts.MISSES]
    rows = [replace(ROW, judgement=word, touches=number > 0) for number, word in enumerate(words)]
    assert page.summary(rows) == (
        "5 of 6 conditions agree (1 of them without contact, 2 of them as distributions), "
        "0 cannot be judged, 1 misses"
    )
    alike = [
        replace(ROW, judgement=verdicts.AS_DISTRIBUTION)
    ] * 4  # the number on the tile of a report
    assert page.counts(alike)[0] == "4 of 4"
    assert page.summary([replace(ROW, judgement=verdicts.CANNOT)], "fitted ") == (
        "0 of 1 fitted conditions agree, 1 cannot be judged, 0 miss"
    )


def test_a_floor_is_unknown_where_a_neighbour_does_not_settle():
    """The neighbour that settles says little then, and the floor widens no gate. Control: with both
    neighbours it is the larger change."""
    nominal, lost = constant(3.0, 0.0, 4.0), flight(status="jammed")
    near, far = constant(3.0, 0.01, 4.0), constant(3.0, 0.5, 4.0)
    both = verdicts.spread("phi15", "reference", "clearance", nominal, [near, far])
    assert both.settled_rate_change_deg_s == pytest.approx(0.5, rel=1e-9)
    half = verdicts.spread("phi15", "reference", "clearance", nominal, [far, lost])
    assert half.settled_rate_change_deg_s is None
    other = Spread("phi15", "surrogate", "clearance", 0.003, 0.09)
    floor, _, measured = Context([half, other], CONVERGED, GATES).floor("phi15")
    assert floor is None and measured
    limits = Context([half, other], CONVERGED, GATES).limits(floor)
    assert limits.settled_rate_error_deg_s == GATES.settled_rate_error_deg_s
    assert Context([both, other], CONVERGED, GATES).floor("phi15")[0] == pytest.approx(0.5)
