"""Displacement of the walls by friction along the rail, condensed with the compliance."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from tests.highfi.support import tiny
from tipoff import highfi
from tipoff.highfi import compliance
from tipoff.highfi.rail import inputs
from tipoff.highfi.rail.places import Patches
from tipoff.highfi.statics import assembly
from tipoff.mechanics.rail_compliance import pairs, residual
from tipoff.scenes import load

SIZE = 4e-3


@pytest.fixture(scope="module")
def condensed():
    return highfi.condense(tiny(), SIZE)


def test_it_is_the_symmetric_part(condensed):
    """Maxwell and Betti hold for pressure alone: friction pulls another way than the wall is
    measured. Control: the full displacement of a face is not symmetric."""
    found = pairs.whole(condensed.dragged, condensed.rail)
    np.testing.assert_allclose(found, found.transpose(0, 3, 4, 1, 2), atol=1e-12 * found.max())
    one = compliance.along(tiny(), SIZE, condensed.travel[3:4], dragged=3).dragged[0]
    square = one[:, :3].reshape(one.shape[0] * 3, -1)
    assert np.abs(square - square.T).max() > 0.1 * np.abs(square).max()


def test_one_solution_gives_it(condensed):
    """Traction along X in the patterns of a face, solved once with another factor: the mean of the
    displacement of each wall of the rail."""
    scene, station = tiny(), 5
    own, rail = inputs.of_scene(scene), compliance.rails(scene, SIZE)[0]
    found = compliance.along(scene, SIZE, condensed.travel[station : station + 1], dragged=3)
    patches = Patches(rail.rail, 1, 1)
    half = condensed.half
    places = patches.under(
        own.faces, half, rail.images[0], own.reach, condensed.travel[station : station + 1]
    )[0]
    operator = assembly.of_material(rail.rail, scene.rail.material, joint=own.joint)
    free = np.repeat(operator.free, 3)
    factor = splu(assembly.sparse(operator)[free][:, free].tocsc())
    drag = patches.loads(friction=True).toarray()[free]
    moved = patches.loads().toarray()[free].T @ factor.solve(drag)
    faces = np.flatnonzero(places >= 0)
    assert faces.size >= 2
    for i in faces:
        for j in faces:
            assert found.dragged[0, i, 0, j, 0] == pytest.approx(
                moved[places[i], places[j]], rel=1e-9, abs=1e-9 * np.abs(moved).max()
            )


def test_its_size_on_the_clamped_rail():
    """Relative to the compliance under a pad, at the coefficient of the scene."""
    scene = load("clamped")
    found = highfi.condense(scene, SIZE)
    faces = np.arange(found.rail.size)
    own = found.compliance()[:, faces, faces]
    every = pairs.whole(found.dragged, found.rail)
    share = scene.friction.dynamic * every[:, faces, 0, faces, 0] / own
    whole = np.isclose(found.part, [0.0, 1.0], atol=1e-9).all(axis=2)
    assert np.abs(share[whole]).max() == pytest.approx(0.0167, abs=5e-4)


def test_friction_acts_half_a_wall_from_the_middle_of_the_leg(condensed):
    """Under a force Q along X on its surface, a leg of thickness t has the couple t Q / 2. By
    reciprocity its mean displacement is t / 2 times the slope of the wall under a unit pressure, half
    of the change of the compliance along the rail: D = t C' / 4. A leg is no thin plate, so the curves
    are compared by their correlation and size. Control: a shift by a pad's length."""
    scene = tiny()
    face = 0
    own = condensed.compliance()[:, face, face]
    slope = np.gradient(own, condensed.travel)
    expected = 0.25 * scene.rail.thickness * slope
    found = pairs.whole(condensed.dragged, condensed.rail)[:, face, 0, face, 0]
    whole = np.isclose(condensed.part[:, face], [0.0, 1.0]).all(axis=1)  # away from both ends
    inside = np.flatnonzero(whole)[2:-2]
    likeness = np.corrcoef(found[inside], expected[inside])[0, 1]
    assert likeness > 0.95
    assert 0.6 < np.std(found[inside]) / np.std(expected[inside]) < 1.6
    assert np.corrcoef(found[inside], np.roll(expected, 8)[inside])[0, 1] < 0.6


def test_all_modes_together_have_the_friction_of_statics():
    """sum (W V' + V W') / (2 omega^2) of 20, 60 and 200 modes, against one solution of the elements: what
    is missing falls to 0.5 %. Control: modes that friction does not drive have none of it."""
    found = highfi.condense(tiny(), 2.0 * SIZE, modes=200)
    size = np.linalg.norm(found.dragged)
    missing = [np.linalg.norm(residual.dragged(found, count)) / size for count in (20, 60, 200)]
    assert 0.7 > missing[0] > 4.0 * missing[1] and missing[2] < 5e-3
    still = replace(found, dragged_shape=None)
    np.testing.assert_array_equal(residual.dragged(still, 200), found.dragged)
