"""Both elastic kernels carry the same run, and any number of threads the same bits."""

import functools
import os

import numpy as np
import pytest

from tests.highfi.support import (
    SOON,
    assert_same_bits,
    parts,
    replace_constants,
    tiny,
    without_columns,
)
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.simulation import Loop
from tipoff.highfi.state.threads import processors

NUMERICS = Numerics(element_size=0.008)
SCENES = {"soon": SOON, "early": {"duration": "5 ms", "contact__clearance": "0.01 mm"}}
TWO_SCENES = pytest.mark.parametrize(
    "scene", ["soon", pytest.param("early", marks=pytest.mark.slow)]
)


def begun(kernel: str, named: str, threads: int = 1, **overrides) -> Loop:
    """A run on the extruded rails of ``tiny`` at its first sample, by columns or by elements."""
    scene = tiny(**SCENES[named], **overrides)
    system = parts(scene, NUMERICS)[0]
    if kernel == "elements":
        system = without_columns(system)
    loop = Loop(set_up(scene, system, choose(system, scene, NUMERICS), threads))
    loop.begin()
    return loop


@functools.cache
def run(kernel: str, named: str, threads: int = 1, spins: int | None = None):
    """The result of such a run; ``spins`` of a thread that waits, in place of the usual number."""
    loop = begun(kernel, named, threads)
    if spins is not None:
        replace_constants(loop, team=loop.setup.team._replace(spins=spins))
    loop.integrate(None)
    return loop.trajectory({}, NUMERICS)


@TWO_SCENES
def test_columns_and_elements_carry_the_same_run(scene):
    columns, elements = run("columns", scene), run("elements", scene)
    assert np.abs(columns.pad_force).max() > 1.0
    assert np.abs(columns.rate - elements.rate).max() <= 1e-9 * np.abs(elements.rate).max()
    assert columns.checks["transverse_energy_error"] <= 1e-3


@pytest.mark.case("X20")
@TWO_SCENES
@pytest.mark.parametrize("kernel", [pytest.param("columns", marks=pytest.mark.slow), "elements"])
def test_threads_do_not_change_a_bit(kernel, scene):
    """Three threads divide the four rails inside a rail, so that their shares depend on each
    other."""
    alone = run(kernel, scene)
    assert np.abs(alone.pad_force).max() > 0.0
    shared = run(kernel, scene, threads=3)
    assert_same_bits(shared, alone)


@TWO_SCENES
def test_threads_that_sleep_at_every_barrier_give_the_same_bits(scene):
    assert_same_bits(run("elements", scene, threads=2, spins=0), run("elements", scene))


@pytest.mark.parametrize("most, expected", [("", 3), ("2", 2), ("9", 3), ("0", 3), ("2,1", 3)])
def test_the_environment_limits_the_threads_of_a_run(most, expected, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 5}, raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", most)
    assert processors() == expected
