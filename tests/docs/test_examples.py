"""The examples of ``docs/examples``: what the page of sliders changes, computes and sends, and both
notebooks as scripts. ``test_what_if`` looks at the page in a browser."""

import json
import os
import subprocess
import sys
from operator import attrgetter

import numpy as np
import pytest

import tipoff
from docs.examples.launcher import answer, controls, message
from tests.docs.pages import ROOT

EXAMPLES = ROOT / "docs" / "examples"


@pytest.fixture(scope="module")
def scene():
    return tipoff.load("tiny").condition("h9")  # all errors at once


@pytest.fixture(scope="module")
def compliance(scene):
    return tipoff.compliance(scene, element_size=8e-3)


@pytest.fixture(scope="module")
def run(scene, compliance):
    return answer.run(scene, compliance)


@pytest.mark.parametrize("name", tipoff.catalog())
def test_sliders_that_nobody_moved_change_nothing(name):
    found = tipoff.load(name)
    assert controls.overrides(found, controls.of_scene(found)) == {}


def test_a_moved_slider_changes_its_key_alone(scene):
    begun = controls.of_scene(scene)
    assert len(begun) == len(controls.CONTROLS)
    for control, start in begun.items():
        moved = start + control.step
        keys = controls.overrides(scene, begun | {control: moved})
        assert set(keys) - {"friction.static"} == {control.key}
        changed = attrgetter(control.key)(scene.replace(keys))
        assert changed == pytest.approx(moved * control.si)


def test_static_friction_keeps_its_ratio_and_single_clearances_follow(scene):
    own = scene.replace({"friction.static": 0.3, "contact.clearance_y": "0.2 mm"})
    begun = controls.of_scene(own)
    by_key = {control.key: control for control in begun}
    moved = {by_key["friction.dynamic"]: 0.1, by_key["contact.clearance"]: 0.1}
    changed = own.replace(controls.overrides(own, begun | moved))
    assert changed.friction.static == pytest.approx(0.15)
    assert changed.contact.gaps() == pytest.approx((1e-4, 1e-4, 1e-4))


def test_what_a_scene_lacks_has_no_slider():
    bare = tipoff.load("tiny").replace(
        {"friction": "absent", "thrust.peak": None, "thrust.impulse": "60 N*s"}
    )
    keys = {control.key for control in controls.of_scene(bare)}
    assert not keys & {"friction.dynamic", "thrust.peak"}
    assert "contact.clearance" in keys


def test_a_value_beyond_the_range_widens_it():
    strong = tipoff.load("tiny").replace({"thrust.peak": "50 kN"})
    (found,) = (item for item in controls.of_scene(strong) if item.key == "thrust.peak")
    assert found.high == pytest.approx(100.0)


def test_rows_are_the_motion_relative_to_the_platform(scene, run):
    """Against the relative motion that the result file has, and matrices of the quaternions."""
    sent = message.made(scene, run)
    rows = np.frombuffer(sent["rows"], "<f4").reshape(-1, sent["width"])
    assert sent["width"] == 14 + len(scene.pads) and 2 <= len(rows) <= message.MOST_ROWS
    kept = np.searchsorted(1e3 * run.time, rows[:, 0] - 1e-3)
    data = run.to_xarray()
    platform, payload = (_matrices(q[kept]) for q in (run.platform_quaternion, run.quaternion))
    turned = np.einsum("nji,njk->nik", platform, payload)
    offset = np.array(scene.mass_offset.eccentricity.offset())
    centre = data.relative_position.values[kept] + [scene.platform.mass_centre.x, 0.0, 0.0]
    assert rows[:, 1:4] == pytest.approx(1e3 * (centre - turned @ offset), abs=1e-4)
    # the angles are small: the skew part of a matrix is its rotation vector
    skew = np.stack([turned[:, 2, 1], turned[:, 0, 2], turned[:, 1, 0]], axis=1)
    assert rows[:, 4:7] == pytest.approx(skew, abs=1e-5)
    assert rows[:, 7:10] == pytest.approx(np.degrees(run.rate[kept]), abs=1e-5)
    forces = np.linalg.norm(run.pad_force[kept].reshape(len(rows), -1, 2, 3).sum(axis=2), axis=2)
    assert rows[:, 14:] == pytest.approx(forces, rel=1e-5, abs=1e-5)
    assert forces.max() > 100.0


def _matrices(quaternions: np.ndarray) -> np.ndarray:
    """Rotation matrices (n,3,3) of unit quaternions (n,4), scalar first, written out."""
    w, x, y, z = quaternions.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def test_the_drawn_payload_begins_on_the_axis_without_its_mass_offset(scene, compliance):
    """Control of the place of the drawing: the mass centre begins off the axis, the body on it."""
    first = np.frombuffer(message.made(scene, answer.run(scene, compliance))["rows"], "<f4")[:14]
    assert first[1:7] == pytest.approx(np.zeros(6), abs=1e-6)
    assert np.hypot(*scene.mass_offset.eccentricity.offset()[1:]) > 1e-4


def test_walls_lie_outside_the_body_and_each_is_drawn_once(scene):
    drawn = message.launcher(scene)
    assert len(drawn["walls"]) == 8  # four L rails
    for wall in drawn["walls"]:
        assert wall["sign"] * wall["face"] > drawn["body"][wall["axis"]]
    assert drawn["gaps"] == pytest.approx([0.25] * 3)


@pytest.mark.parametrize("name", tipoff.catalog())
def test_every_scene_of_the_catalogue_can_be_drawn(name):
    found = tipoff.load(name)
    drawn = message.launcher(found)
    assert min(drawn["body"]) > 0.0 and len(drawn["pads"]) == len(found.pads)
    assert all(wall["across"][0] < wall["across"][1] for wall in drawn["walls"])
    json.dumps([drawn, message.loads(found)], allow_nan=False)


def test_an_ejection_that_does_not_settle_says_so(scene, compliance):
    short = scene.replace({"duration": "4 ms"})
    said = message.answer(short, answer.quick(short, compliance))
    assert said["status"] != "exited" and said["rate"] is None and said["exit_ms"] is None


def test_the_page_has_the_error_of_the_run(scene, compliance, run):
    """In its words, and the range of a sensitive run. Control: a free payload has an error and no range."""
    found, said = run.error.range, message.error(run)
    assert said["is_sensitive"] and f"the range is that of {found.runs} runs" in said["words"]
    assert f"z {found.low_deg_s[2]:.3f} to {found.high_deg_s[2]:.3f} deg/s" in said["words"]
    free = scene.replace({"contact": "absent", "friction": "absent"})
    assert answer.compliance(free) is None
    own = answer.run(free, None)
    assert message.error(own) == {"words": own.error.words, "is_sensitive": False}
    assert own.error.rate_deg_s < 1e-6


@pytest.mark.parametrize("name", ["tour.py", "what_if.py"])
def test_an_example_runs_as_a_script(name):
    pytest.importorskip("marimo", reason="marimo is not installed: make examples installs it")
    pytest.importorskip("anywidget", reason="anywidget is not installed: make examples installs it")
    said = subprocess.run(
        [sys.executable, EXAMPLES / name, "--scene", "tiny", "--count", "16"],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=540,
    )
    assert said.returncode == 0, said.stdout + said.stderr
    if name == "tour.py":
        assert "16 of 16 payloads left the rails" in said.stdout
