"""A rail whose file is as fine as the mesh asked for: the refinement of the mesh splits it once more,
or the convergence is not known."""

import functools
from pathlib import Path

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff.comparison.extrapolation import estimate
from tipoff.highfi.rail import memory_estimate, refinement
from tipoff.scenes import load
from tipoff.studies.agreement import refinement as by
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.verdicts import NOT_KNOWN, Context
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

# The walls of the catalogue's channel are 4 mm thick, in one element.
FILE_SIZE, SLOPE = 0.004, 50.0  # m; deg/s per m: error of a rate by the mesh
READ = refinement.read


@functools.cache
def read_once(path):
    """The file of all conditions, as the catalogue says it."""
    return READ(path, refinement.asked(load("channel").rail))


@pytest.fixture
def study(monkeypatch):
    """Runs with an error of the first order in the size of the elements that the mesh really has."""
    made = Study(load("channel"), Path("nowhere"), Settings(element_size=FILE_SIZE))

    @functools.cache
    def size_of(asked):
        return refinement.sizes(made.scene, [asked])[0]  # all conditions have one rail

    def fill(store, title, runs):
        found = []
        for run in runs:
            rate = np.radians([3.0 + SLOPE * size_of(run.numerics.element_size), 0.0, 4.0])
            found.append(flight(lambda t, rate=rate: np.tile(rate, (t.size, 1))))
        return found

    monkeypatch.setattr(type(made.store), "fill", fill)
    monkeypatch.setattr(refinement, "read", lambda path, _: read_once(path))
    return made


def by_mesh(study):
    return [item for item in by.refinements(study) if item.cause == "mesh"]


def test_sizes_are_those_of_the_meshes_that_the_file_gives():
    scene, asked = load("channel"), [0.008, 0.004, 0.0025, 0.002, 0.001]
    assert refinement.sizes(scene, asked) == pytest.approx([0.004, 0.004, 0.002, 0.002, 0.001])
    assert refinement.sizes(load("reference"), asked) == asked


def test_the_file_is_split_once_more_and_first_order_is_assumed(study):
    """Half the error is the change, the other half has a factor of three. Control: the runs in
    elements of 8 and 4 mm, which are the same mesh, do not differ."""
    found = by_mesh(study)
    assert [item.condition for item in found] == list(study.conditions)
    for item in found:
        change = 0.5 * SLOPE * FILE_SIZE
        assert item.settled_rate_change_deg_s == pytest.approx(change, rel=1e-6)
        assert item.uncertainty_deg_s == pytest.approx(change + 3.0 * change, rel=1e-6)
    name = next(iter(study.conditions))
    runs = study.store.fill("same", [study.coarse(name), study.highfi(name)])
    assert verdicts.settled_change(*runs) == 0.0


@pytest.mark.parametrize("scarce", ["memory", "time"])
def test_convergence_is_not_known_where_the_finer_mesh_does_not_fit(study, monkeypatch, scarce):
    if scarce == "memory":
        monkeypatch.setattr(memory_estimate, "available", lambda: 1e6)
    else:
        monkeypatch.setattr(refinement, "LONGEST", 1.0)
    context = Context([], by.refinements(study), verdicts.gates(study.scene))
    name = next(iter(study.conditions))
    still = flight(lambda t: np.zeros((t.size, 3)))
    row = verdicts.row(name, "held_out", still, still, context)
    assert row.reference_uncertainty_deg_s is None and not row.reference_converged
    assert row.verdict == NOT_KNOWN


def test_meshes_of_the_convergence_study_differ(study, monkeypatch):
    """8 and 4 mm are one mesh; 2 and 1 mm are two more. With less time only two are left, and no
    uncertainty is told. Control: equal meshes alone seem to be exact."""
    name = next(iter(study.conditions))
    scene = study.condition(name)
    asked, sizes = by.mesh_sizes(study, scene, study.settings.mesh_sizes, 3)
    assert asked == [0.004, 0.002]
    assert sizes == pytest.approx([0.004, 0.002])
    one = Study(study.scene, study.folder, Settings(element_size=0.016))
    monkeypatch.setattr(refinement, "LONGEST", 1.0)
    asked, sizes = by.mesh_sizes(one, scene, one.settings.mesh_sizes, 3)
    assert asked == [0.016] and sizes == pytest.approx([0.004])
    assert estimate(sizes, [3.0]).uncertainty is None
    assert estimate([4.0, 2.0, 1.0], [3.0, 3.0, 3.0]).uncertainty == 0.0
