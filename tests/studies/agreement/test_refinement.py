"""Uncertainty of the reference from settled rates of a known order."""

from pathlib import Path

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff.comparison.extrapolation import NOT_CONVERGED
from tipoff.scenes import load
from tipoff.studies.agreement.refinement import MESH, STEP, groups, refinement
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

SIZES = [8.0, 4.0, 2.0]


def settling(rates):
    """A run that settles at ``rates`` (3,) deg/s."""
    return flight(lambda t: np.tile(np.radians(rates), (t.size, 1)))


def runs(law):
    return [settling(law(size)) for size in SIZES]


@pytest.mark.parametrize("order", [0.7, 1.0, 2.0])
def test_the_axis_with_the_largest_error_decides(order):
    """Of known limits: the error of the finest is 0.01 * 2^p about y. Control: the last change is
    smaller than that error where the order is below one."""
    found = refinement(
        "c", MESH, SIZES, runs(lambda h: (1.0 + 1e-4 * h, 2.0 - 0.01 * h**order, 3.0)), 2
    )
    error = 0.01 * 2.0**order
    assert found.order == pytest.approx(order, abs=1e-6) and found.method == "GCI"
    assert found.uncertainty_deg_s == pytest.approx(1.25 * error, rel=1e-6)
    assert (found.settled_rate_change_deg_s < error) == (order < 1.0) or order == 1.0


def test_the_uncertainty_is_that_of_the_run_that_is_used():
    """The coarsest step is what every other stage runs: its error, 0.64, is within what lies
    between the values and the uncertainty of the finest."""
    found = refinement("c", STEP, SIZES, runs(lambda h: (0.01 * h**2, 0.0, 0.0)), 0)
    assert found.uncertainty_deg_s == pytest.approx(0.64 - 0.04 + 1.25 * 0.04)


def test_changes_that_do_not_fall_are_no_convergence():
    """Rates that go to and fro. Control: with changes that fall they are."""
    found = refinement("c", MESH, SIZES, runs(lambda h: (0.1 * (h == 4.0), 0.0, 0.0)), 2)
    assert found.method == NOT_CONVERGED
    assert found.uncertainty_deg_s == pytest.approx(0.3)
    falling = refinement("c", MESH, SIZES, runs(lambda h: (1e-3 * h, 0.0, 0.0)), 2)
    assert falling.method == "GCI" and falling.uncertainty_deg_s == pytest.approx(2.5e-3)


def test_a_run_that_did_not_settle_leaves_it_unknown():
    found = refinement(
        "c", MESH, SIZES, [*runs(lambda h: (h, 0.0, 0.0))[:2], flight(status="jammed")], 2
    )
    assert found.uncertainty_deg_s is None and found.method == "a run did not settle"


def test_one_mesh_leaves_it_unknown():
    """Control: compared with itself it would seem to be exact."""
    (mesh, *_) = runs(lambda h: (1.0, 0.0, 0.0))
    alone = refinement("c", MESH, SIZES[:1], [mesh], 0)
    assert alone.uncertainty_deg_s is None and alone.method == "one grid: not known"
    assert alone.rate_relative_l2 is None
    assert refinement("c", MESH, SIZES[:2], [mesh, mesh], 1).uncertainty_deg_s == 0.0


def test_a_scene_with_finer_meshes_only_needs_no_further_mesh():
    """The mesh that other stages use for differences comes before that of the reference. Control: a mesh
    of half the size would take sixteen times as long as the reference."""
    settings = Settings(element_size=0.008, mesh_ratios=(1.0, 0.6))
    study = Study(load("tiny"), Path("nowhere"), settings)
    name = next(iter(study.conditions))
    mesh = groups(study, name)[MESH]
    assert mesh.sizes == [0.016, 0.008] and mesh.used == 1
    assert [run.key for run in mesh.runs] == [study.coarse(name).key, study.highfi(name).key]
