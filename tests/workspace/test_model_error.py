"""The error of a run by its model: exact parts, what it covers, and the range of a sensitive run."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import tipoff
from tipoff.faults import Fault
from tipoff.results import shown
from tipoff.results.model_error import ModelError
from tipoff.results.trajectory import Trajectory
from tipoff.workspace import model_error

TINY = tipoff.load("tiny")
TAME = "phi0", "phi15", "phi35", "phi60", "phi90"


@pytest.fixture(scope="module")
def walls() -> tipoff.RailCompliance:
    return tipoff.compliance(TINY)


def change(first: Trajectory, second: Trajectory) -> float:
    return float(np.degrees(np.abs(np.subtract(first.outcome.rate, second.outcome.rate)).max()))


def uncertain(
    walls: tipoff.RailCompliance, by: float, slower: float = 0.0
) -> tipoff.RailCompliance:
    every = np.full(walls.rail.size, by)
    return replace(walls, uncertainty=every, frequency_uncertainty=slower)


def test_the_error_is_the_root_of_the_sum_of_squares():
    found = ModelError(parts_deg_s={"rail mesh": 3.0, "tolerance": 4.0})
    assert found.rate_deg_s == 5.0 and found.largest == "tolerance"
    assert ModelError.of(found.plain()) == found and ModelError(not_known="so").rate_deg_s is None


@pytest.mark.parametrize("by", [0.0, 0.05, 0.1])
def test_an_injected_error_of_the_compliance_is_the_part_of_the_mesh(walls, by):
    """Every face alike: the compliance is the multiple, and so is the square of each mode. Control: without
    an error the part is zero."""
    scene = TINY.condition("phi15")
    run = tipoff.run(scene, compliance=uncertain(walls, by))
    larger = replace(
        walls,
        flexibility=(1.0 + by) * walls.flexibility,
        dragged=(1.0 + by) * walls.dragged,
        shape=np.sqrt(1.0 + by) * walls.shape,
        dragged_shape=np.sqrt(1.0 + by) * walls.dragged_shape,
    )
    modes = run.numerics["modes"]
    expected = change(run, tipoff.run(scene, compliance=larger, sensitivity=False, modes=modes))
    assert run.error.parts_deg_s["rail mesh"] == pytest.approx(expected, rel=1e-5, abs=1e-9)
    assert (expected > 0.01) == (by > 0.0)


def test_lower_frequencies_change_no_static_compliance(walls):
    """The compliance without the part of the modes stays positive, or ``residual`` would refuse it."""
    softer = uncertain(walls, 0.1, 0.05).softer
    assert softer.frequency == pytest.approx(walls.frequency / 1.05)
    modal = walls.shape / walls.frequency[walls.rail][None, :, None, :]
    softer_modal = softer.shape / softer.frequency[walls.rail][None, :, None, :]
    assert softer_modal == pytest.approx(np.sqrt(1.1) * modal)
    assert softer.residual(20) == pytest.approx(1.1 * walls.residual(20))


@pytest.mark.slow
@pytest.mark.parametrize("condition", TAME)
def test_the_error_covers_the_difference_to_finer_elements(walls, condition):
    """Elements of a half and a quarter of the size. Control: the difference is no small part of it."""
    scene = TINY.condition(condition)
    run = tipoff.run(scene, compliance=walls)
    finest = tipoff.run(scene, element_size=2e-3, sensitivity=False, modes=20)
    finer = tipoff.run(scene, element_size=4e-3, sensitivity=False, modes=20)
    error = run.error.rate_deg_s
    assert change(run, finer) < error and 0.2 * error < change(run, finest) < error


def test_the_error_covers_elements_of_half_the_size(walls):
    scene = TINY.condition("phi35")
    run = tipoff.run(scene, compliance=walls)
    finer = tipoff.run(scene, element_size=4e-3, sensitivity=False)
    assert 0.2 * run.error.rate_deg_s < change(run, finer) < run.error.rate_deg_s


def test_each_part_is_a_change_of_the_numerics(walls):
    scene = TINY.condition("phi15")
    run = tipoff.run(scene, compliance=walls, modes=0)
    parts = run.error.parts_deg_s
    for name, other in (
        ("rail modes", {"modes": 20}),
        ("pad patterns", {"modes": 0, "degree": 2}),
        ("contact cells", {"modes": 0, "cells": 32}),
        ("tolerance", {"modes": 0, "relative_tolerance": 1e-10}),
    ):
        moved = tipoff.run(scene, compliance=walls, sensitivity=False, **other)
        assert parts[name] == pytest.approx(change(run, moved), rel=1e-12)
    every = tipoff.run(scene, compliance=walls, modes=20)
    assert "rail modes" not in every.error.parts_deg_s


def test_further_runs_take_the_kernel_of_the_run(walls, monkeypatch):
    """A kernel is compiled for the number of patterns. A run with fewer patterns compiled another one, in 20 s of
    the first run."""
    kinds, execute = set(), model_error.execute

    def recorded(run):
        kinds.add((run.compliance.degree, run.numerics.known_degree))
        return execute(run)

    monkeypatch.setattr(model_error, "execute", recorded)
    assert "pad patterns" in tipoff.run("tiny", compliance=walls).error.parts_deg_s
    assert kinds == {(walls.degree, None)}


def test_a_further_run_without_a_place_of_rest_leaves_the_answer(walls, monkeypatch):
    """Its fault is the reason why the error is not known. Control: a fault of the run itself is raised."""
    fault = Fault("tiny", "initial.settled", "a force is left", "walls that hold the payload")

    def refused(run):
        raise tipoff.SceneError([fault])

    monkeypatch.setattr(model_error, "execute", refused)
    run = tipoff.run(TINY.condition("phi15"), compliance=walls)
    assert run.outcome.rate is not None and run.error.rate_deg_s is None
    assert "initial.settled" in run.error.not_known
    # Control:
    with pytest.raises(tipoff.SceneError, match="settled"):
        tipoff.run(TINY.replace({"initial.settled": True}), compliance=walls)


def test_a_factor_on_the_mounts_is_kept():
    """The softer rail stands on the mounts of the scene: the part changes continuously with the factor."""
    joints = {"rail.mount_stiffness.normal": 1e13, "rail.mount_stiffness.shear": 5e12}
    scene = TINY.condition("phi15").replace(joints)
    walls = tipoff.compliance(scene)

    def part(factor: float) -> float:
        looser = scene.replace({"rail.mount_stiffness.factor": factor})
        return tipoff.run(looser, compliance=walls, modes=0).error.parts_deg_s["rail mesh"]

    assert part(0.999) == pytest.approx(part(1.0), rel=0.05)
    assert part(0.5) != pytest.approx(part(1.0), rel=1e-3)


def test_what_is_not_known_is_said(walls, tmp_path):
    unstated = tipoff.run(TINY.condition("phi15"), compliance=replace(walls, uncertainty=None))
    assert unstated.error.not_known == "rail mesh: not stated by this rail compliance"
    springs = tipoff.run(TINY.condition("phi15"), "springs")
    assert springs.error.rate_deg_s is None and "springs" in springs.summary()
    assert tipoff.run(TINY, compliance=walls, sensitivity=False).error is None
    springs.save(tmp_path / "run.nc")
    assert Trajectory.load(tmp_path / "run.nc").error == springs.error


def test_a_sensitive_run_has_the_range_of_its_neighbours(walls):
    """It has the run itself and those of 1 um either way. Control: a tame run has an error."""
    scene = TINY.condition("h7")
    run = tipoff.run(scene, compliance=walls)
    found = run.error.range
    assert run.error.rate_deg_s is None and found.runs + found.lost == 10
    gap, modes = scene.contact.clearance, run.numerics["modes"]
    for step in (0.0, 1e-6, -1e-6):
        other = scene.replace({"contact.clearance": gap + step})
        outcome = tipoff.run(other, compliance=walls, sensitivity=False, modes=modes).outcome
        rate, (x, y, z) = np.degrees(outcome.rate), outcome.velocity
        across, off = math.hypot(y, z), math.degrees(math.acos(x / math.hypot(x, y, z)))
        assert found.across_m_s[0] - 1e-9 <= across <= found.across_m_s[1] + 1e-9
        assert found.off_axis_deg[0] - 1e-7 <= off <= found.off_axis_deg[1] + 1e-7
        assert (np.array(found.low_m_s) <= np.array([x, y, z]) + 1e-9).all()
        assert (np.array([x, y, z]) - 1e-9 <= np.array(found.high_m_s)).all()
        assert (np.array(found.low_deg_s) <= rate + 1e-9).all()
        assert (rate - 1e-9 <= np.array(found.high_deg_s)).all()
    assert max(np.subtract(found.high_deg_s, found.low_deg_s)) > 0.1
    assert found.across_m_s[1] - found.across_m_s[0] > 1e-6
    assert ModelError.of(json.loads(run.error.written())) == run.error
    text = shown.facts(run)
    assert all(text[name].count(" to ") >= 2 for name in ("velocity", "rate", "direction"))
    assert f"{found.runs} runs" in text["error"]
    assert tipoff.run(TINY.condition("phi15"), compliance=walls).error.range is None
    assert len(found.rates_deg_s) == found.runs
    assert found.within(lambda rates: rates[0]) == (found.low_deg_s[0], found.high_deg_s[0])
