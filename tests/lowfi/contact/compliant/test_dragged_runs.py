"""Runs with friction that drags the walls, against the finite elements."""

from dataclasses import replace

import pytest

from tests.lowfi.compliance import REFERENCE
from tipoff import highfi, lowfi
from tipoff.comparison.metrics import compare

# Rails without much inertia follow the pads as in statics, which is all that the law is tested for;
# on a fixed platform nothing else moves.
LIGHT = {"rail.material.density": "28.1 kg/m**3", "platform": "absent"}
SIZE = 4e-3


@pytest.mark.slow
def test_the_finite_elements_have_it():
    """Rates of a run of two contacts with the cells of the reference and patterns of the fourth
    degree: 0.1 % (L2). Control: walls that friction does not move are half as far again."""
    scene = REFERENCE.replace(LIGHT).condition("phi0")
    reference = highfi.run(scene, highfi.Numerics(element_size=SIZE))
    walls = highfi.condense(scene, SIZE, degree=4)
    errors = []
    for dragged in (walls.dragged, None):
        run = lowfi.run(
            scene,
            compliance=replace(walls, dragged=dragged),
            numerics=lowfi.Numerics(modes=0, cells=16),
        )
        errors.append(compare(reference, run).rate_relative_l2)
    assert errors[0] < 1.1e-3
    assert errors[1] > 1.4 * errors[0]
