"""Changes that are added to what a scene and its condition state, and clearances along one axis."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.lowfi.compliance import reference_compliance
from tests.scenes.test_calibration import CALIBRATION
from tipoff import lowfi
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Listed
from tipoff.scenes import SceneError, changes, load, scene_model
from tipoff.workspace.run import Run

SCENE = load("clamped")
TILT = 2e-3
CHANGES = {
    "thrust_offset.misalignment.y": TILT,
    "mass_offset.eccentricity.z": -1e-4,
    "initial.position.y": 5e-6,
    "payload.inertia.xy": 1e-4,
}
FITTED = replace(CALIBRATION, constants={"contact.clearance": 0.26e-3}, changes=CHANGES)


def test_components_are_added_to_what_a_condition_states():
    """The direction (cos t, sin t cos p, sin t sin p) gains the tilt along y, up to its square."""
    for name in ("phi35", "h7", "h9"):
        before, after = SCENE.condition(name), FITTED.apply(SCENE.condition(name))
        old, new = (
            np.array(scene.thrust_offset.misalignment.direction()) for scene in (before, after)
        )
        np.testing.assert_allclose(new[1:] - old[1:], [TILT, 0.0], atol=2e-4 * TILT)
        assert after.payload.inertia.xy == before.payload.inertia.xy + 1e-4
        assert after.contact.clearance == 0.26e-3


def test_an_absent_table_counts_as_zero():
    h6 = SCENE.condition("h6")
    assert h6.thrust_offset is None
    after = FITTED.apply(h6)
    assert after.thrust_offset.misalignment.axial == pytest.approx(TILT)
    expected = np.add(h6.mass_offset.eccentricity.offset(), [0.0, 0.0, -1e-4])
    np.testing.assert_allclose(after.mass_offset.eccentricity.offset(), expected, atol=1e-18)
    along = changes.overrides(SCENE, {"thrust_offset.eccentricity.y": 1e-4})
    assert along["thrust_offset.eccentricity.radial"] == pytest.approx(math.radians(90.0))


def test_a_change_of_no_key_is_a_scene_error():
    with pytest.raises(SceneError, match="no such key"):
        replace(FITTED, changes={"payload.spin": 1.0}).apply(SCENE)


def test_changes_travel_as_a_file(tmp_path):
    FITTED.save(tmp_path / "c.toml")
    read = type(FITTED).load(tmp_path / "c.toml")
    assert read.apply(SCENE).hash == FITTED.apply(SCENE).hash != SCENE.hash
    assert read.applied == FITTED.applied and "changes" not in CALIBRATION.applied


def test_other_changes_are_another_run_and_another_ensemble():
    """Control: a calibration without changes has the key it had before there were any."""
    other = replace(FITTED, changes=CHANGES | {"initial.position.y": 6e-6})
    plain = replace(FITTED, changes={})
    runs = [
        Run("lowfi", "phi35", SCENE, lowfi.Numerics(), found) for found in (FITTED, other, plain)
    ]
    assert len({run.key for run in runs}) == 3
    many = [
        Ensemble(SCENE, Listed([{"friction.dynamic": 0.1}]), found, lowfi.Numerics()).key
        for found in (FITTED, other, plain)
    ]
    assert len(set(many)) == 3
    assert plain.applied == plain.constants


def test_a_case_of_an_ensemble_replaces_constants_and_gets_the_changes():
    """To the bit what a run of the case does. Control: changes that the case replaces."""
    rows = [
        {"thrust_offset.misalignment.axial": 0.003, "thrust_offset.misalignment.radial": 1.0},
        {"contact.clearance": 0.24e-3},
    ]
    compliance = reference_compliance()
    plain = {"compliance": compliance, "numerics": lowfi.Numerics(modes=0)}
    found = lowfi.run_many(SCENE, rows, calibration=FITTED, **plain).rate.values
    constants = SCENE.replace(FITTED.constants)
    for row, rate in zip(rows, found):
        scene = constants.replace(row)
        scene = scene.replace(changes.overrides(scene, CHANGES))
        np.testing.assert_array_equal(rate, lowfi.run(scene, **plain).outcome.rate)
    replaced = FITTED.apply(SCENE).replace(rows[0])
    lost = lowfi.run(replaced, **plain).outcome.rate
    assert np.abs(np.subtract(lost, found[0])).max() > 1e-3


def test_a_clearance_along_one_axis_is_that_of_its_faces():
    scene = SCENE.replace({"contact.clearance_z": 0.1e-3})
    faces = scene_model.built(scene).nominal
    origin = np.array(scene_model.build(scene).platform.mass_centre)
    gap = faces.sign * (faces.wall + origin[faces.axis] - faces.centre[range(16), faces.axis])
    np.testing.assert_allclose(gap, np.where(faces.axis == 1, 0.25e-3, 0.1e-3), rtol=1e-9)
    np.testing.assert_array_equal(faces.wall, scene_model.built(SCENE).nominal.wall)


def test_one_clearance_along_both_axes_is_the_clearance():
    """The walls stay and the faces move, so the arms differ by the change. Control: other ones."""
    compliance, phi35 = reference_compliance(), SCENE.condition("phi35")
    both = {"contact.clearance_y": 0.26e-3, "contact.clearance_z": 0.26e-3}
    shims = lowfi.run(phi35.replace(both), compliance=compliance).outcome.rate
    moved = lowfi.run(phi35.replace({"contact.clearance": 0.26e-3}), compliance=compliance)
    np.testing.assert_allclose(shims, moved.outcome.rate, rtol=2e-3, atol=1e-5)
    as_before = lowfi.run(phi35, compliance=compliance).outcome.rate
    assert np.abs(np.subtract(as_before, shims)).max() > 1e-3


@pytest.mark.parametrize("stated", ["", "y", "z", "yz"])
def test_a_change_of_the_clearance_is_one_of_every_gap(stated):
    """Control: where both axes state their own, the clearance itself changes no gap."""
    scene = SCENE.replace({f"contact.clearance_{axis}": 0.1e-3 for axis in stated})
    wide = scene.replace(scene.contact.widened(2e-6))
    grown = np.subtract(wide.contact.gaps(), scene.contact.gaps())[1:]
    np.testing.assert_allclose(grown, 2e-6, rtol=1e-9)
    other = scene.replace({"contact.clearance": 0.3e-3})
    assert (other.contact.gaps()[1:] == scene.contact.gaps()[1:]) is (stated == "yz")
    assert list(scene.contact.either_way(2e-6)) == ["plus", "minus"]
    assert list(scene.contact.either_way(0.2e-3)) == ["plus", "minus"][: 1 if stated else 2]
