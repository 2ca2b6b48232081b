"""Runs with friction that drags the walls, against the finite elements."""

import math
from dataclasses import replace

import numpy as np
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


@pytest.mark.slow
def test_what_remains_is_the_grain_of_the_elements():
    """A pad meets the borders of elements at another place with another thrust. With patterns of the
    fourth degree the error of the settled roll is then -0.003 or +0.005 deg/s, with the place of
    contact 1 mm farther on. Control: stations 0.5 mm apart do not change it."""
    still = {"platform": "absent", "friction": "absent", "duration": "80 ms"}
    scene = REFERENCE.replace(still).condition("phi0")
    numerics = lowfi.Numerics(modes=20, cells=16, relative_tolerance=1e-6)
    walls, near = (highfi.condense(scene, SIZE, degree=4, spacing=each) for each in (2e-3, 5e-4))
    errors, places = [], []
    for peak in ("6.2 kN", "7.2 kN"):
        asked = scene.replace({"thrust.peak": peak})
        reference = highfi.run(asked, highfi.Numerics(element_size=SIZE))
        rolls = [
            math.degrees(run.outcome.rate[0])
            for run in (
                reference,
                *(lowfi.run(asked, compliance=each, numerics=numerics) for each in (walls, near)),
            )
        ]
        errors.append(rolls[1] - rolls[0])
        hardest = np.abs(reference.pad_force).sum(axis=(1, 2)).argmax()
        places.append(reference.position[hardest, 0])
        assert rolls[2] == pytest.approx(rolls[1], abs=1e-3)
    assert -0.004 < errors[0] < -0.002 and 0.004 < errors[1] < 0.006
    assert 0.0 < places[1] - places[0] < 2e-3
