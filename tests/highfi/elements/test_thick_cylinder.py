"""Curved solids, up to nearly incompressible ones: the thick cylinder of Lame."""

import pytest

from tests.exact import elasticity
from tests.highfi import cylinder

TWO_MESHES = pytest.mark.parametrize("refinement", [4, 6])


def ratio(refinement, poisson_ratio, bubbles=True):
    """Displacement of the inner wall over Lame's."""
    found = cylinder.solve(refinement, poisson_ratio, bubbles)
    exact = elasticity.pressed_cylinder_displacement(
        cylinder.INNER,
        cylinder.INNER,
        cylinder.OUTER,
        cylinder.PRESSURE,
        cylinder.MODULUS,
        poisson_ratio,
    )
    return found.radial[found.radius < 1.0001 * cylinder.INNER].mean() / exact


@pytest.mark.case("O11")
@TWO_MESHES
@pytest.mark.parametrize("poisson_ratio, answer", [(0.3, 4.58250e-3), (0.49, 5.03993e-3)])
def test_thick_cylinder(refinement, poisson_ratio, answer):
    """u = (1 + nu) p a^2 ((1 - 2 nu) r + b^2 / r) / E (b^2 - a^2) at the inner wall."""
    exact = elasticity.pressed_cylinder_displacement(3.0, 3.0, 9.0, 1.0, 1000.0, poisson_ratio)
    assert exact == pytest.approx(answer, abs=6e-9)
    assert ratio(refinement, poisson_ratio) == pytest.approx(1.0, rel=5e-3)
    # Control: without bubbles the hexahedron locks, by more than 1.5 % already at nu = 0.49 on
    # these meshes.
    if poisson_ratio == 0.49:
        assert ratio(refinement, poisson_ratio, bubbles=False) < 0.985


@pytest.mark.case("X15")
@TWO_MESHES
@pytest.mark.parametrize("poisson_ratio, locked", [(0.499, 0.9), (0.4999, 0.4)])
def test_nearly_incompressible_cylinder_does_not_lock(refinement, poisson_ratio, locked):
    assert ratio(refinement, poisson_ratio) == pytest.approx(1.0, rel=0.02)
    # Control: without bubbles it locks.
    assert ratio(refinement, poisson_ratio, bubbles=False) < locked
