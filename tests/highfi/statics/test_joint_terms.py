"""Rail compliance at a factor on the stiffness of the mounts, against its condensation there."""

import copy

import numpy as np
import pytest

from tests.highfi.support import tiny
from tipoff import highfi
from tipoff.calibration import rail_compliance
from tipoff.highfi import compliance
from tipoff.highfi.rail import inputs
from tipoff.mechanics.rail_compliance import RailCompliance, residual
from tipoff.mechanics.rail_compliance.joint_terms import LEAST, MOST
from tipoff.scenes import SceneError
from tipoff.scenes.rail_compliance import of_scene, require

SIZE, KEY = 8e-3, "rail.mount_stiffness.factor"
NORMAL, SHEAR = 1e13, 5e12


def on_joints(factor=1.0, **changed):
    return tiny(
        rail__mount_stiffness__normal=NORMAL * factor,
        rail__mount_stiffness__shear=SHEAR * factor,
        rail__material__expansion=23.6e-6,
        **changed,
    )


@pytest.fixture(scope="module")
def nominal():
    return highfi.condense(on_joints(), SIZE, joints=True)


def largest(found, exact):
    return np.abs(found - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize("factor", [0.4, pytest.param(2.0, marks=pytest.mark.slow)])
def test_a_factor_gives_what_condensation_there_gives(nominal, factor):
    """Flexibility and thermal offset to 1e-6, frequencies of the lowest modes to 1e-4. What is
    left beside the modes is positive. Controls: the nominal stiffness is off by a tenth and more
    under whole faces,
    and linear interpolation in 1 / k between 1/4, 1 and 4 by more than 1e-4."""
    found = of_scene(nominal, on_joints().replace({KEY: factor}))
    exact = highfi.condense(on_joints(factor), SIZE)
    assert largest(found.flexibility, exact.flexibility) < 1e-6
    assert largest(found.warm, exact.warm) < 1e-6
    assert largest(found.dragged, exact.dragged) < 1e-6
    whole = np.isclose(exact.part, [0.0, 1.0], atol=1e-9).all(axis=(1, 2))
    assert largest(nominal.flexibility[whole], exact.flexibility[whole]) > 0.1
    assert found.frequency[:, :10] == pytest.approx(exact.frequency[:, :10], rel=1e-4)
    assert (found.frequency >= exact.frequency * (1.0 - 1e-9)).all()
    found.residual(20)
    rest = residual.dragged(exact, 10)
    assert largest(residual.dragged(found, 10), rest) < 1e-3
    assert largest(exact.dragged, rest) > 0.1
    softer, stiffer = ((LEAST, 1.0), (1.0, MOST))[int(factor > 1.0)]
    ends = [
        of_scene(nominal, on_joints().replace({KEY: end})).flexibility for end in (softer, stiffer)
    ]
    share = (1.0 / factor - 1.0 / stiffer) / (1.0 / softer - 1.0 / stiffer)
    assert largest(share * ends[0] + (1.0 - share) * ends[1], exact.flexibility) > 1e-4


def test_what_it_is_made_for(nominal):
    """The nominal compliance serves every factor within its range, of the same two stiffnesses."""
    scene = on_joints()
    assert of_scene(nominal, scene) is nominal
    require(nominal, scene.replace({KEY: MOST}))
    for factor in (0.99 * LEAST, 1.01 * MOST):
        with pytest.raises(SceneError, match="0.25 to 4"):
            require(nominal, scene.replace({KEY: factor}))
    with pytest.raises(SceneError, match="another rail"):
        require(nominal, on_joints(2.0))
    with pytest.raises(SceneError, match="fewer patterns"):
        require(nominal.restricted(1), scene.replace({KEY: 2.0}))
    half = highfi.condense(scene.replace({KEY: 0.5}), SIZE)
    np.testing.assert_array_equal(half.flexibility, nominal.flexibility)


def test_it_is_computed_for_the_first_factor(nominal, tmp_path):
    """A compliance has the terms of its joints as soon as a run has a factor, in memory, in its folder
    and in the file that a user saves. Its identity does not depend on whether it has them."""
    scene, said = on_joints(), []
    for found in (
        rail_compliance.compliance(scene, SIZE),
        rail_compliance.kept(scene, tmp_path, SIZE, said.append),
    ):
        assert found.joints is None and found.hash == nominal.hash
        half = of_scene(found, scene.replace({KEY: 0.5}))
        np.testing.assert_array_equal(
            half.shape, of_scene(nominal, scene.replace({KEY: 0.5})).shape
        )
        found.save(tmp_path / "rail.npz")
        read = RailCompliance.load(tmp_path / "rail.npz")
        np.testing.assert_array_equal(read.joints.moved, nominal.joints.moved)
    [stored] = tmp_path.glob("joints-*.npz")
    before = stored.stat().st_mtime_ns
    again = copy.deepcopy(found)  # as another process gets it: the fields alone
    np.testing.assert_array_equal(of_scene(again, scene.replace({KEY: 0.5})).shape, half.shape)
    assert stored.stat().st_mtime_ns == before


def test_a_file_holds_it(nominal, tmp_path):
    nominal.save(tmp_path / "rail.npz")
    read = RailCompliance.load(tmp_path / "rail.npz")
    assert read.hash == nominal.hash
    scene = on_joints().replace({KEY: 2.0})
    np.testing.assert_array_equal(
        of_scene(read, scene).flexibility, of_scene(nominal, scene).flexibility
    )


def test_one_pattern_that_friction_does_not_drag():
    """As the convergence study asks for: the same numbers as with friction, and none of it."""
    scene = on_joints()
    held, own = compliance.rails(scene, SIZE), inputs.of_scene(scene)
    without, dragged = (
        compliance.of_rails(held, own.faces, own.reach, [0.0, 0.05], 1, 4, count, joints=True)
        for count in (0, 1)
    )
    assert without.joints.moved_by_friction.shape[2] == without.joints.moved_first.shape[2] == 0
    assert largest(without.joints.moved, dragged.joints.moved) < 1e-12
    assert largest(without.matrix, dragged.matrix) < 1e-12
