"""Runs keep the limits of their ledgers, with smaller steps where needed, or they are diverged and
give no rates."""

import numpy as np
import pytest

from tests.lowfi.compliance import reference_compliance
from tests.lowfi.random_scenes import EFFECTS, independent, scene_of
from tests.lowfi.support import PAPER_PAD, scene, unwatched
from tipoff import lowfi
from tipoff.lowfi.dynamics import audit
from tipoff.lowfi.single_run import SingleRun, improved
from tipoff.mechanics import promises
from tipoff.scenes import load

REFERENCE = load("clamped").condition("phi35")
QUICK = ("ejection", "guided", "frictionless", "free")  # kernels that other tests compile too
# Rattles between walls without clearance, so that hundreds of contacts add up: no law with this
# exponent is smooth where it touches.
RATTLING = REFERENCE.replace(
    {
        "duration": 0.03,
        "thrust.peak": 100.0,
        "contact.damping": 0.0,
        "contact.clearance": 0.0,
        "contact.stiffness": 4.7e9,
        "friction.static": 0.0,
        "friction.dynamic": 0.0,
        "payload.mass": 2.0,
        "initial.velocity.y": -0.05,
        "initial.velocity.z": -0.05,
        "initial.attitude.x": -1e-3,
        "initial.attitude.y": -1e-3,
        "initial.rate.x": -0.5,
        "initial.rate.z": 0.5,
    }
)


def assert_kept(run) -> None:
    """An accepted run keeps every accuracy limit; the message of a diverged one names the limit
    that it broke, and it has no rate."""
    words = promises.broken(run.checks, promises.RIGID)
    assert (run.status == "diverged") == bool(words), words
    if words:
        assert words in run.message and run.outcome.rate is None


@pytest.mark.parametrize("kind", QUICK)
def test_a_few_random_scenes_keep_their_promises(kind):
    for raw in independent(kind, range(25)):
        assert_kept(lowfi.run(scene_of(raw), "springs"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", EFFECTS)
def test_random_scenes_keep_their_promises(kind):
    """A hundred of each kind, of which at most three diverge."""
    runs = [lowfi.run(scene_of(raw), "springs") for raw in independent(kind, range(100))]
    for run in runs:
        assert_kept(run)
    assert sum(run.status == "diverged" for run in runs) <= 3


def test_hundreds_of_touches_keep_the_ledger_closed():
    """Control: without the requirement of the ledger on steps in contact their errors add up to
    more than the limit."""
    run = lowfi.run(RATTLING, "springs")
    assert_kept(run)
    assert run.status == "time_limit" and run.cost["events"] > 200
    free = SingleRun(RATTLING, lowfi.Numerics())
    free.tolerance = free.tolerance._replace(total=1.0, transverse=1.0)
    free.begin()
    free.integrate(None)
    assert audit.errors(free.loop.audit, 1e-6, 1e-4)[0] > 1e-6


@pytest.mark.case("X24")
def test_a_wall_stiffer_than_numbers_resolve_diverges():
    """At 1e30 N/m^1.5 the penetration is below the last digit of a position. The message names the
    steps that were tried."""
    run = lowfi.run(REFERENCE.replace({"contact.stiffness": 1e30}), "springs")
    assert_kept(run)
    assert run.status == "diverged" and "run again" in run.message and run.cost["reruns"] >= 1
    # control: a stiff wall alone is no fault
    stiff = lowfi.run(REFERENCE.replace({"contact.stiffness": 1e18}), "springs")
    assert_kept(stiff)
    assert stiff.status == "exited"


def test_a_broken_ledger_is_run_again_with_smaller_steps():
    """One run loses energy and the next does not: the result has the bits of the tighter
    tolerance."""
    first = SingleRun(REFERENCE, lowfi.Numerics())
    first.begin()
    first.integrate(None)
    assert first.usage() <= 1.0
    first.loop.audit.peak_error = first.loop.audit.scale * 2e-6
    again = improved(first)
    fine = lowfi.run(REFERENCE, "springs", numerics=lowfi.Numerics(relative_tolerance=2e-8))
    found = again.trajectory()
    assert found.outcome == fine.outcome and found.status == "exited"
    assert found.cost["reruns"] == 1 and found.cost["discarded_steps"] == first.loop.counts.steps
    assert "2e-08" in found.message and found.checks["energy_error"] <= 1e-6


def test_energy_given_back_by_lost_contacts_is_an_error():
    """A run in which the released energy decreases has created energy: both ledgers count it,
    though they close."""
    run = SingleRun(REFERENCE, lowfi.Numerics())
    run.begin()
    run.integrate(None)
    before = audit.errors(run.loop.audit, 1e-6, 1e-4)
    run.loop.audit.created = 1e-3 * run.loop.audit.scale
    assert audit.errors(run.loop.audit, 1e-6, 1e-4)[0] == pytest.approx(1e-3) and before[0] < 1e-6
    assert run.trajectory().status == "diverged"


@pytest.mark.case("X24")
@pytest.mark.parametrize("duration", [1e-3, pytest.param(0.058, marks=pytest.mark.slow)])
def test_compliant_walls_at_100_m_s_across(duration):
    """Pads go a hundred times deeper than the clearance. In the long run they come back to the
    walls from outside, which creates energy."""
    run = lowfi.run(
        REFERENCE.replace({"initial.velocity.y": 100.0, "duration": duration}),
        compliance=reference_compliance(),
    )
    if "no contact is modelled there" in run.message:  # pressed through the wall
        assert run.status == "diverged" and run.outcome.rate is None
    else:
        assert_kept(run)


def test_a_case_of_an_ensemble_is_run_again_too():
    """Rows have the bits of single runs, also rows that diverge or are run again."""
    rows = [{"contact.stiffness": value} for value in (1e10, 1e18, 1e30)]
    found = lowfi.run_many(REFERENCE, rows, "springs")
    for number, row in enumerate(rows):
        alone = lowfi.run(REFERENCE.replace(row), "springs")
        assert found.status.values[number] == alone.status
        if alone.status == "exited":
            assert found.rate.values[number].tolist() == alone.outcome.rate
    assert found.status.values.tolist() == ["exited", "exited", "diverged"]


@pytest.mark.parametrize(
    "changes",
    [
        {
            "thrust_offset.misalignment.axial": 0.0,
            "payload.inertia.xy": 0.0,
            "payload.inertia.xz": 0.0,
        },
        {
            "thrust_offset.misalignment.axial": 0.0,
            "payload.inertia.xy": 0.0,
            "payload.inertia.xz": 0.0,
            "thrust.reaction": "exhaust",
        },
    ],
)
def test_an_aligned_ejection_is_off_by_rounding_only(changes):
    """There is no motion across the rail and no moment: the rest of either is rounding and breaks
    no limit."""
    run = lowfi.run(REFERENCE.replace(changes), "springs")
    assert run.status == "exited" and run.checks["transverse_energy_error"] <= 1e-5
    assert (
        run.checks["angular_momentum_error"] <= 1e-13
        and run.checks["linear_momentum_error"] <= 1e-13
    )


def test_forces_that_cancel_leave_a_momentum_of_rounding():
    """A payload at rest between opposed pads: the momentum is zero, the forces are a kilonewton
    each."""
    opposed = [
        {"position": (0.0, 0.0, side * 0.1), "normals": [sign]}
        for side, sign in ((-1, "-z"), (1, "+z"))
    ]
    run = lowfi.run(
        scene(
            0.004,
            1e-4,
            pads=opposed,
            contact=PAPER_PAD | {"clearance": 0.0},
            gravity={"z": -9.80665},
            initial={"velocity": {"x": 1e-9}},
        ),
        "springs",
    )
    assert_kept(run)
    assert np.abs(run.pad_force).max() > 0.0


def test_works_that_cancel_are_the_scale_of_the_ledger():
    """A thrust carries the weight of a body that rises slowly: its kinetic energy is a thousandth of
    either work. Control: an error of a millionth of the works is seen."""
    mass, weight, duration, speed = 20.0, 2e5, 0.05, 1.0
    run = unwatched(
        scene(
            duration,
            1e-3,
            mass=mass,
            thrust={"kind": "constant", "force": weight, "duration": duration},
            gravity={"x": -weight / mass},
            initial={"velocity": {"x": speed}},
        ),
        lowfi.Numerics(),
    )
    works = 2.0 * weight * speed * duration
    assert run.loop.audit.scale == pytest.approx(works, rel=1e-9) and works > 5e2 * mass * speed**2
    assert run.trajectory().checks["energy_error"] <= 1e-12
    run.loop.audit.peak_error = 2e-6 * works
    assert run.trajectory().status == "diverged"
