"""Static deflection of a rail whose mounts are accelerated, against bars of known stretch."""

import numpy as np
import pytest

from tests.highfi.support import bar_mesh, spinning_bar_stretch
from tipoff import highfi
from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics.inertial import TERMS, deflections
from tipoff.scenes import load

MATERIAL = load("reference").rail.material.model_copy(update={"poisson_ratio": 0.0})
DENSITY, MODULUS, LENGTH = MATERIAL.density, MATERIAL.youngs_modulus, 0.1


def terms(linear=(0.0, 0.0, 0.0), gradient=np.zeros((3, 3))) -> np.ndarray:
    """``linear`` (3,) m/s2 and ``gradient`` (3,3) 1/s2 in their order."""
    return np.concatenate([linear, np.ravel(gradient)])


def bar() -> RailMesh:
    """A bar along X, held at its root."""
    return bar_mesh(LENGTH, 0.005, 40)


def test_an_accelerated_bar_shrinks_as_under_its_weight():
    """rho a L^2 / (2 E) at the tip (Timoshenko and Goodier, bar under its weight). Lumped masses
    give that at the nodes of a uniform mesh exactly."""
    (found,) = deflections(bar(), MATERIAL, None, 10_000)
    moved = found.under(terms(linear=(100.0, 0.0, 0.0)))
    expected = -DENSITY * 100.0 * LENGTH**2 / (2.0 * MODULUS)
    assert moved[:, 0].min() == pytest.approx(expected, rel=1e-9)
    assert np.abs(moved[:, 1:]).max() < 1e-6 * abs(expected)


def test_a_spinning_bar_stretches():
    """Centripetal acceleration is -w^2 X; the error of 40 elements is of order two."""
    (found,) = deflections(bar(), MATERIAL, None, 10_000)
    moved = found.under(terms(gradient=np.diag([-(30.0**2), 0.0, 0.0])))
    expected = spinning_bar_stretch(DENSITY, 30.0, LENGTH, MODULUS)
    assert moved[:, 0].max() == pytest.approx(expected, rel=2.0 / 40**2)


def test_frequency_of_an_accelerated_bar():
    """Rayleigh's quotient of the parabola, sqrt(5/2) sqrt(E/rho) / L, is 0.7 % above the first
    axial frequency, pi/2 sqrt(E/rho) / L."""
    (found,) = deflections(bar(), MATERIAL, None, 10_000)
    expected = np.sqrt(2.5 * MODULUS / DENSITY) / LENGTH
    assert found.frequency[0] == pytest.approx(expected, rel=1e-3)
    # it stretches along X, so its walls do not move across it
    assert found.size[0] < 1e-9 * DENSITY * LENGTH**2 / (2.0 * MODULUS)


def test_size_is_that_of_walls_across_the_rail():
    """Along X a rail moves as a strut: the walls across it less than the ends along it."""
    rail = load("reference").rail
    mesh = highfi.prepare(load("reference"), highfi.Numerics(element_size=0.008))
    found = deflections(mesh, rail.material, rail.joint(), 10_000)[0]
    walls = [group for name, group in mesh.surfaces.items() if name.startswith("contact")]
    own = np.isin(found.own, np.concatenate([group.ravel() for group in walls]))
    moved = np.linalg.norm(found.shapes[:, own, 1:], axis=2)
    assert found.size == pytest.approx(moved.max(axis=1), rel=1e-12)
    assert 0.0 < found.size[0] < 0.7 * np.abs(found.shapes[0, :, 0]).max()


def test_mirror_images_share_one_solution():
    """Four rails have one factor; each one's deflection is the one that its own factor gives.
    Control: without the signs it is not."""
    mesh = highfi.prepare(load("reference"), highfi.Numerics(element_size=0.008))
    material, amounts = load("reference").rail.material, np.linspace(-1.0, 2.0, TERMS)
    found = deflections(mesh, material, None, 10_000)
    assert len(found) == 4 and {tuple(each.signs) for each in found} == {
        (1.0, y, z) for y in (1.0, -1.0) for z in (1.0, -1.0)
    }
    for each, solid in zip(found, pieces.pieces(mesh)):
        (alone,) = deflections(solid, material, None, 10_000)
        expected = alone.under(amounts)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(each.under(amounts), expected, rtol=0.0, atol=1e-9 * scale)
        if (each.signs < 0.0).any():
            unsigned = each._replace(signs=np.ones(3)).under(amounts)
            assert np.abs(unsigned - expected).max() > 0.1 * scale


def test_what_cannot_be_solved():
    """A rail that nothing holds, and one that is larger than allowed."""
    loose = RailMesh(bar().points, bar().cells, bar().surfaces | {"mount": np.zeros((0, 4), int)})
    assert deflections(loose, MATERIAL, None, 10_000) is None
    assert deflections(bar(), MATERIAL, None, 10) is None
