"""Patterns of other degrees than the default, and friction that drags the walls: one potential of all
forces, and fewer patterns of a compliance that has more."""

import numpy as np
import pytest

from tests.lowfi.compliance import (
    BASES,
    CELLS,
    REFERENCE,
    SMOOTH,
    derivative,
    energy,
    forces_of,
    generalised,
    pose_of,
    pressed,
    solved,
)
from tipoff import highfi, lowfi, scenes
from tipoff.mechanics.rail_compliance import patterns
from tipoff.scenes import SceneError

COEFFICIENT = 0.3


@pytest.fixture(scope="module")
def fifth():
    """Rail compliance of the reference scene for patterns of the fifth degree, in elements of 8
    mm."""
    return highfi.condense(REFERENCE, 8e-3, degree=5)


def dragged(compliance):
    """Model and records with friction that drags the walls and has no other force."""
    model, system = pressed(REFERENCE.replace(SMOOTH), compliance)
    system.compliance.workspace.friction[0] = COEFFICIENT
    return model, system


@pytest.mark.parametrize("degree", [1, 3, 5])
@pytest.mark.parametrize("name", ["all faces of a rail, tilted", "front pads over the end"])
def test_forces_are_the_gradient_of_the_energy(fifth, degree, name):
    """dE = -forces . twist for each way either body can move, with friction that drags the walls.
    Control: without it the forces are others."""
    model, system = dragged(fifth.of_degree(degree))
    pose, h = pose_of(model, name, BASES["moved and turned"]), 1e-9
    forces = generalised(pose, derivative(system, model, pose, np.zeros(12)))
    slopes = np.array(
        [
            (
                energy(system, model, pose.moved(twist, h))
                - energy(system, model, pose.moved(twist, -h))
            )
            / (2.0 * h)
            for twist in np.eye(12)
        ]
    )
    size = np.abs(forces).max()
    assert slopes == pytest.approx(-forces, abs=1e-6 * size, rel=0.0)
    system.compliance.workspace.friction[0] = 0.0
    still = generalised(pose, derivative(system, model, pose, np.zeros(12)))
    assert np.abs(still - forces).max() > 1e-4 * size


@pytest.mark.parametrize("degree", [1, 3, 5])
def test_pressures_are_those_of_the_plain_equations(fifth, degree):
    """U = (F + mu D) P(U), cell by cell."""
    compliance = fifth.of_degree(degree)
    model, system = dragged(compliance)
    pose, workspace = pose_of(model, "both legs"), system.compliance.workspace
    rail = int(compliance.rail[np.argmax(workspace.force[:, 0])])
    for rail in range(len(system.compliance.members)):
        faces = workspace.order[: solved(system, model, pose, rail)].copy()
        wall, force = workspace.displacement[faces], workspace.force[faces]
        expected = [
            forces_of(compliance, model, CELLS, face, pose, each) for face, each in zip(faces, wall)
        ]
        assert force == pytest.approx(np.array(expected), rel=1e-9, abs=1e-9 * np.abs(force).max())


def test_a_lower_degree_is_the_compliance_that_is_condensed_for_it(fifth):
    """Flexibility, friction and shapes; the mean of a face differs in the rounding of integrals over
    facets alone. Control: the first patterns of the higher degree, without projection."""
    lower, exact = fifth.of_degree(2), highfi.condense(REFERENCE, 8e-3, degree=2)
    size = patterns.count(2)
    # near an end, degrees see other parts
    whole = np.isclose(exact.part, [0.0, 1.0], atol=1e-9).all(axis=(1, 2))
    assert whole.sum() > 15
    for name in ("flexibility", "dragged", "shape", "dragged_shape"):
        found, wanted = getattr(lower, name)[whole], getattr(exact, name)[whole]
        assert np.abs(found - wanted).max() < 1e-2 * np.abs(wanted).max()
    cut, wanted = fifth.flexibility[whole][..., :size, :size], exact.flexibility[whole]
    assert np.abs(cut - wanted).max() > 0.05 * np.abs(wanted).max()
    assert fifth.of_degree(5) is fifth and fifth.of_degree(2) is lower


def test_patterns_are_a_number_of_the_run(fifth):
    """Without a degree a run has that of its compliance. A higher one is refused, and so is one for
    springs."""
    scene = REFERENCE.replace({"friction": "absent"}).condition("phi35")
    numerics = lowfi.Numerics(modes=0)
    given = {"compliance": fifth.of_degree(2), "numerics": numerics}
    first = lowfi.run(scene, **given)
    second = lowfi.run(scene, compliance=fifth, numerics=lowfi.Numerics(modes=0, degree=2))
    np.testing.assert_array_equal(first.rate, second.rate)
    with pytest.raises(SceneError, match="at most 2.*degree=3"):
        lowfi.run(scene, compliance=given["compliance"], numerics=lowfi.Numerics(degree=3))
    with pytest.raises(SceneError, match="springs stand on rigid rails"):
        lowfi.run(scenes.load("clamped"), "springs", numerics=lowfi.Numerics(modes=0, degree=3))
