"""Displacements that are not small against the rail end a run."""

import numpy as np
import pytest

from tests.highfi.blocks import block
from tests.highfi.rail.test_spin import bar
from tests.highfi.support import bar_mesh, begun, loop_on
from tests.highfi.tets import split
from tipoff.highfi.dynamics import linear_range
from tipoff.kernels import rotation


@pytest.mark.parametrize(
    "mesh", [block((3, 2, 2), (0.3, 0.1, 0.2)), split(block((2, 1, 1), (0.3, 0.1, 0.2)))]
)
def test_gradients_of_rotations_and_strains(mesh):
    """A linear rotation by a and a stretch by e have the norms a and e; a turn by the angle a has
    2 sin(a/2)."""
    nodes = mesh.points[mesh.cells]
    for gradient, norm in (
        (np.array([[0, -0.05, 0], [0.05, 0, 0], [0, 0, 0]]), 0.05),
        (np.diag([0.02, -0.006, -0.006]), 0.02),
        (
            rotation.matrices(np.array(rotation.exponential((0.3, 0.4, 0.0)))[None])[0] - np.eye(3),
            2 * np.sin(0.25),
        ),
    ):
        found = linear_range.gradients(nodes, nodes @ gradient.T + 7.0)
        np.testing.assert_allclose(found, norm, rtol=1e-9)


def test_an_arm_that_swings_far_ends_its_run():
    """An arm of 10 m whose tip has 2 m/s: its root turns by more than a tenth within seconds. Control:
    with a hundredth of the speed it swings on."""
    length, messages = 10.0, []
    for speed in (10.0, 0.1):
        mesh = bar_mesh(length, 0.1, 100)
        loop = loop_on(bar(0.0, length, duration=0.6).replace({"output.interval": 0.02}), mesh)
        x = mesh.points[:, 0] / length
        loop.stepper.state.velocity[loop.setup.system.number, 2] = speed * x**2
        loop.begin()
        for _ in range(25):
            if not loop.recorded.message:
                loop.advance_one_sample()
        messages.append(loop.recorded.message)
    assert "the rails turn or stretch by up to 0.1" in messages[0]
    assert "linear elasticity holds up to 0.1, at 0." in messages[0] and messages[1] == ""


def test_the_quick_look_misses_nothing():
    """A displacement of the harmless size, up in one layer of nodes and down in the next, has a
    gradient below the limit."""
    loop = loop_on(bar(0.0), bar_mesh(0.6, 0.02, 30))
    moved = np.zeros(loop.stepper.state.displacement.shape)
    number, x = loop.setup.system.number, loop.setup.system.mesh.points[:, 0]
    moved[number] = (loop.setup.small / np.sqrt(3.0)) * np.where(np.round(x / 0.02) % 2, 1.0, -1.0)[
        :, None
    ]
    found, place = linear_range.largest(loop.setup.system, moved)
    assert 0.5 * linear_range.MOST < found <= linear_range.MOST
    assert linear_range.fault(loop.setup.system, moved, loop.setup.small) == ""
    assert "linear elasticity" in linear_range.fault(
        loop.setup.system, 2.5 * moved, loop.setup.small
    )
    assert 0.0 < place[0] < 0.6


@pytest.mark.slow
def test_the_tiny_scene_is_far_from_the_limit():
    loop, worst = begun(), 0.0
    while len(loop.recorded.rows) < 300 and not loop.recorded.message:
        loop.advance_one_sample()
        worst = max(
            worst, linear_range.largest(loop.setup.system, loop.stepper.state.displacement)[0]
        )
    assert 0.0 < worst < 0.05 * linear_range.MOST
