"""Modes of a clamped rail and the displacement of the walls under pads in them: beam theory, and a
full set that adds up to the compliance."""

import numpy as np
import pytest
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from tests.exact import elasticity
from tests.highfi.test_compliance import HEIGHT, LENGTH, MODULUS, WIDTH, beam, pads
from tipoff.highfi import compliance
from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.statics import assembly, vibration
from tipoff.highfi.statics.held import distinct
from tipoff.scenes.rail_base import MaterialTable

DENSITY = 2700.0
# At a Poisson ratio of zero the clamp of a solid is that of beam theory.
MATERIAL = MaterialTable.model_validate(
    {"density": DENSITY, "youngs_modulus": MODULUS, "poisson_ratio": 0.0},
    context={"bare_numbers_are_si": True},
)
PADS = pads(0.21, 0.45)


@pytest.mark.case("O7")
def test_frequencies_of_a_cantilever():
    """The modes that move its top up and down are those that bend it across its height."""
    found = compliance.of_rails(
        distinct(beam(), MATERIAL), PADS, (0.0, LENGTH), (0.0,), patterns=1, modes=8
    )
    moving = np.abs(found.shape[0, :, 0]).max(axis=0)
    across = found.frequency[0][moving > 0.1 * moving.max()] / (2.0 * np.pi)
    exact = elasticity.timoshenko_cantilever(3, LENGTH, WIDTH, HEIGHT, MODULUS, 0.0, DENSITY)
    assert across[:3] == pytest.approx(exact, rel=0.01)
    assert (np.diff(found.frequency[0]) >= 0.0).all() and across.size < 8


@pytest.fixture(scope="module")
def coarse():
    """Compliance and all modes under two pads of a beam of 180 freedoms."""
    return compliance.of_rails(
        distinct(beam((10, 1, 2)), MATERIAL),
        PADS,
        (0.0, LENGTH),
        (0.0, 0.03),
        patterns=3,
        modes=180,
    )


def without(found, modes):
    """Residual compliance (s,w,w) after so many modes, over w = faces times patterns."""
    size = found.matrix.shape[1] * found.matrix.shape[2]
    part = (
        found.shape.reshape(-1, size, found.shape.shape[-1])[..., :modes]
        / found.frequency[0, :modes]
    )
    return found.matrix.reshape(-1, size, size) - part @ part.transpose(0, 2, 1)


@pytest.mark.case("O7")
def test_all_modes_add_up_to_the_compliance(coarse):
    size = np.abs(coarse.matrix).max()
    assert np.abs(without(coarse, 180)).max() < 1e-8 * size
    # Controls: without the mode that bends the beam under its pads most is missing, and its mass
    # off by a thousandth is seen.
    main = (np.abs(coarse.shape).max(axis=(0, 1, 2)) / coarse.frequency[0]).argmax()
    assert (
        np.abs(without(coarse, main + 1)).max() < 0.2 * size < np.abs(without(coarse, main)).max()
    )
    heavier = coarse._replace(swung=coarse.swung * np.where(np.arange(180) == main, 1.0005, 1.0))
    assert np.abs(without(heavier, 180)).max() > 1e-4 * size


def test_residual_compliance_is_never_negative(coarse):
    """It decreases with every further mode."""
    size = np.abs(coarse.matrix).max()
    before = without(coarse, 0)
    for modes in (1, 2, 5, 20, 60):
        after = without(coarse, modes)
        assert np.linalg.eigvalsh(after).min() > -1e-12 * size
        assert np.linalg.eigvalsh(before - after).min() > -1e-12 * size
        before = after


def test_few_modes_are_the_lowest_of_all(coarse, monkeypatch):
    """An iteration finds the same frequencies, and shapes but for their signs. Control: it says if it
    does not converge."""
    monkeypatch.setattr(vibration, "FEW", (0, 20))
    found = compliance.of_rails(
        distinct(beam((10, 1, 2)), MATERIAL), PADS, (0.0, LENGTH), (0.0, 0.03), patterns=3, modes=8
    )
    assert found.frequency[0] == pytest.approx(coarse.frequency[0, :8], rel=1e-10)
    assert np.abs(found.shape) == pytest.approx(
        np.abs(coarse.shape[..., :8]), abs=1e-9 * np.abs(coarse.shape[..., :8]).max()
    )
    monkeypatch.setattr(vibration, "MOST", (0, 2))
    with pytest.raises(MeshError, match="the 8 lowest modes of a rail do not converge"):
        compliance.of_rails(
            distinct(beam((10, 1, 2)), MATERIAL), PADS, (0.0, LENGTH), (0.0,), patterns=1, modes=8
        )


def test_modes_of_one_frequency_are_all_found():
    """Three times each, as pairs of a round section are twice."""
    square = np.repeat(np.arange(1.0, 301.0), 3)
    stiffness, ones = csc_array(np.diag(square)), np.ones(900)
    frequency, shape = vibration.modes(stiffness, ones, splu(stiffness).solve, 8)
    assert frequency**2 == pytest.approx([1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0], rel=1e-12)
    assert np.abs(shape.T @ shape - np.eye(8)).max() < 1e-12
    assert np.abs(shape[9:]).max() < 1e-11


def test_shapes_have_unit_mass(monkeypatch):
    monkeypatch.setattr(vibration, "FEW", (0, 20))
    operator = assembly.build(beam((10, 1, 2)), MATERIAL.density, MODULUS, 0.0)
    free = np.repeat(operator.free, 3)
    stiffness, mass = (
        csc_array(assembly.sparse(operator)[free][:, free]),
        np.repeat(operator.mass, 3)[free],
    )
    solve = splu(stiffness).solve
    for count in (6, 150):  # by iteration, and all at once
        frequency, shape = vibration.modes(stiffness, mass, solve, count)
        assert np.abs(shape.T @ (mass[:, None] * shape) - np.eye(count)).max() < 1e-9
        assert (
            np.abs(
                shape.T @ (stiffness @ shape) / frequency / frequency[:, None] - np.eye(count)
            ).max()
            < 1e-7
        )
    with pytest.raises(ValueError, match="modes: given 181, expected 0 to 180"):
        vibration.modes(stiffness, mass, solve, 181)


def test_stiffer_and_lighter_material_vibrates_faster():
    def found(factor, lighter):
        changed = MATERIAL.model_copy(
            update={"youngs_modulus": factor * MODULUS, "density": DENSITY / lighter}
        )
        return compliance.of_rails(
            distinct(beam((10, 1, 2)), changed), PADS, (0.0, LENGTH), (0.0,), patterns=1, modes=4
        )

    plain, changed = found(1.0, 1.0), found(16.0, 4.0)
    assert changed.frequency == pytest.approx(8.0 * plain.frequency, rel=1e-9)
    assert np.abs(changed.shape) == pytest.approx(
        2.0 * np.abs(plain.shape), rel=1e-6, abs=1e-6 * np.abs(plain.shape).max()
    )
