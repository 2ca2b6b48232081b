"""Friction that damps nodes faster than a step can follow: a body that lies on a rail and creeps.

A payload under gravity lies with one flat face on the end of a short bar. The face is soft against
the bar, so it presses with the weight from ignition on. The smoothed law of friction lets it creep
down a slope, at a speed that follows from the law alone. The bar is so fine that friction near rest
damps its nodes several times faster than the step of its elastic waves can follow.
"""

import math

import numpy as np
import pytest

from tests.exact.friction import creep_ratio
from tests.highfi.blocks import block
from tests.highfi.support import COARSE, NEUTRAL, begun, loop_on, stopped, tiny
from tipoff import highfi
from tipoff.highfi.dynamics import substeps
from tipoff.highfi.dynamics.checkpoint import Checkpoint, restore
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.numerics import Numerics
from tipoff.mechanics.ledger import ENTRIES
from tipoff.mechanics.promises import FINITE_ELEMENTS
from tipoff.scenes import parse

G, MASS, MU, TRANSITION = 9.80665, 10.0, 0.2, 1e-3  # m/s2, kg, 1, m/s
WIDTH, LENGTH, FACE, CLEARANCE = 0.02, 0.02, 0.01, 1e-6  # m
STIFFNESS = 1e10  # N/m3, of the interface, over which the bar gives way by a thousandth
SLOPES = {5.0: 0.3007, math.degrees(math.atan(0.1)): 0.3473}  # deg: speed over TRANSITION


def scene(slope: float, **overrides):
    """The body on a ``slope`` (deg); it presses with its weight."""
    depth = MASS * G * math.cos(math.radians(slope)) / (STIFFNESS * FACE * WIDTH)
    return parse(
        NEUTRAL
        | {
            "name": "creep",
            "duration": 3e-3,
            "output": {"interval": 1e-4},
            "platform": None,
            "pads": [
                {
                    "position": [0.0, -CLEARANCE, 0.0],
                    "normals": ["+y"],
                    "length": FACE,
                    "width": 2.0 * WIDTH,
                }
            ],
            "payload": {"mass": MASS, "inertia": {"xx": 1e3, "yy": 1e3, "zz": 1e3}},
            "rail": {
                "start": -0.5 * WIDTH,
                "end": 0.5 * WIDTH,
                "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.0},
            },
            "contact": {
                "law": "linear",
                "clearance": CLEARANCE,
                "stiffness": 1.0,
                "interface_stiffness": STIFFNESS,
            },
            "friction": {
                "static": MU,
                "dynamic": MU,
                "static_speed": TRANSITION,
                "dynamic_speed": 2.0 * TRANSITION,
            },
            "gravity": {
                "x": G * math.sin(math.radians(slope)),
                "y": G * math.cos(math.radians(slope)),
                "z": 0.0,
            },
            "initial": {"position": {"y": CLEARANCE + depth}},
        }
        | overrides,
        bare_numbers_are_si=True,
    )


def bar() -> RailMesh:
    """The bar, clamped at its far end."""
    mesh = block((2, 2, 2), (WIDTH, LENGTH, WIDTH))
    facets = boundary_facets(mesh.cells)
    y = mesh.points[facets][:, :, 1]
    walls = {
        "contact_y": facets[(y == 0.0).all(axis=1)],
        "mount": facets[(y == LENGTH).all(axis=1)],
    }
    return RailMesh(mesh.points - [0.5 * WIDTH, 0.0, 0.5 * WIDTH], mesh.cells, walls)


def run(slope: float = 5.0, **overrides):
    """The run in progress, at its end, and its trajectory."""
    loop = loop_on(scene(slope, **overrides), bar())
    loop.begin()
    loop.integrate(None)
    return loop, loop.trajectory({}, Numerics())


@pytest.mark.case("O25")
@pytest.mark.parametrize("slope", SLOPES)
def test_a_body_creeps_down_a_slope_as_fast_as_the_law_says(slope):
    """r (3 - r^2) mu / 2 = tan(slope), r the speed over the transition speed."""
    loop, found = run(slope)
    ratio = creep_ratio(math.radians(slope), MU)
    assert ratio == pytest.approx(SLOPES[slope], abs=5e-5)
    assert found.status == "time_limit"
    assert found.velocity[-5:, 0] == pytest.approx(ratio * TRANSITION, rel=0.01)
    assert loop.recorded.most_substeps > 5
    assert loop.recorded.divided_steps == loop.stepper.steps
    assert loop.recorded.parts > 5 * loop.stepper.steps


@pytest.mark.case("O25")
def test_undivided_steps_do_not_creep(monkeypatch):
    """Control: in whole steps the nodes under the face shake, friction has no hold, and the body
    slides as if the plane were smooth."""
    monkeypatch.setattr(Stepper, "most_damping", np.inf)
    loop, found = run()
    assert loop.recorded.parts == loop.stepper.steps and loop.recorded.damping > 5.0
    smooth = G * math.sin(math.radians(5.0)) * loop.setup.scene.duration
    assert found.velocity[-1, 0] == pytest.approx(smooth, rel=0.05)
    assert smooth > 5.0 * SLOPES[5.0] * TRANSITION


def test_friction_that_no_step_can_follow_ends_the_run(monkeypatch):
    """One more than the most substeps is a fault that names what to change."""
    monkeypatch.setattr(substeps, "MOST", 3)
    loop, found = run(duration=2e-4)
    assert found.status == "diverged" and loop.stepper.steps == 0
    assert "friction damps nodes faster than 3 parts of the step" in found.message
    assert "raise friction.static_speed" in found.message


def on_rails(**overrides):
    """A payload that lies on two rails of a fixed platform, pressed into them by a micrometre; it
    slides, comes near rest, and is lifted off."""
    changes = {
        "duration": "0.6 ms",
        "platform": None,
        "friction": {"static": 0.2, "dynamic": 0.2, "static_speed": 2e-3, "dynamic_speed": 4e-3},
        "initial": {"position": {"z": -0.251e-3}, "velocity": {"x": 1e-3}},
    }
    return tiny(**changes | overrides)


def lying(**overrides):
    """The run of ``on_rails``, at its end."""
    loop = begun(on_rails(**overrides))
    loop.integrate(None)
    return loop


def test_how_coarsely_a_run_is_sampled_changes_no_bit_of_its_substeps():
    fine, coarse = lying(output__interval="0.05 ms"), lying(output__interval="0.3 ms")
    assert 0 < fine.recorded.divided_steps < fine.stepper.steps and fine.stepper.substeps == 1
    costs = [loop.recorded.cost(loop.stepper) for loop in (fine, coarse)]
    for cost in costs:
        del cost["evaluations"]  # a sample evaluates laws too
    assert costs[0] == costs[1]
    np.testing.assert_array_equal(np.array(fine.recorded.rows)[::6], np.array(coarse.recorded.rows))


@pytest.mark.parametrize("samples", [2, 5])
def test_divided_steps_go_on_with_other_threads_to_the_same_bits(tmp_path, samples):
    """Stopped while steps are divided, and resumed from the file by two threads."""
    scene = on_rails(output__interval="0.05 ms")
    first, second = stopped(samples, scene), begun(scene, threads=2)
    kept = Checkpoint(tmp_path / "run", 0.0, first, COARSE)
    kept.write(first)
    assert first.stepper.substeps > 1
    restore(second, kept.read())
    assert (
        second.stepper.substeps == first.stepper.substeps
        and len(second.recorded.rows) == samples + 1
    )
    for loop in (first, second):
        loop.integrate(None)
    np.testing.assert_array_equal(np.array(second.recorded.rows), np.array(first.recorded.rows))
    assert second.recorded.cost(second.stepper) == first.recorded.cost(first.stepper)


def test_balances_hold_where_the_number_of_substeps_changes():
    """The energy that the scheme conserves depends on its step; the ledger has the difference as
    released. Control: without that entry the error is at least ten times as large."""
    loop = lying()
    found = loop.trajectory({}, highfi.Numerics())
    for name in ("energy_error", "transverse_energy_error"):
        assert found.checks[name] < 0.1 * getattr(FINITE_ELEMENTS, name)
    assert found.checks["linear_momentum_error"] < FINITE_ELEMENTS.linear_momentum_error
    assert found.checks["angular_momentum_error"] < FINITE_ELEMENTS.angular_momentum_error
    released = found.energy[:, ENTRIES.index("released")]
    kinetic = found.energy[:, ENTRIES.index("kinetic")].max()
    assert np.abs(released).max() > 10.0 * found.checks["energy_error"] * kinetic


def test_a_step_that_friction_can_follow_is_not_divided():
    """A payload that flies at ignition, as in the catalogue."""
    loop = begun()
    loop.advance_one_sample()
    assert (loop.recorded.most_substeps, loop.recorded.divided_steps) == (1, 0)
