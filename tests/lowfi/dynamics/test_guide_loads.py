"""Largest load of each button or pad: against statics, finer samples and the impulse."""

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import PAPER_PAD, G, scene
from tipoff import lowfi
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes import SceneError, scene_model

MASS = 20.0
SETTLED = {"initial": {"settled": True}}
HELD = {"kind": "constant", "force": 1.0, "start": 4e-3, "duration": 1e-3}
FOUR = [
    {"position": (x, y, -0.1), "normals": ["-z"], "inset": 0.0}
    for x in (-0.1, 0.3)
    for y in (-0.1, 0.1)
]


def button(x: float) -> list[dict]:
    """Six faces of a button at X (m), which is fixed to the body at z = -0.1 m."""
    faces = [(a, -0.103, "-z") for a in (-0.006, 0.006)]
    faces += [(a, -0.108, "+z") for a in (-0.006, 0.006)]
    faces += [(0.004, -0.1055, "+y"), (-0.004, -0.1055, "-y")]
    same = {"length": 0.008, "width": 0.003, "foot": (x, 0.0, -0.1)}
    return [{"position": (x, y, z), "normals": [normal], **same} for y, z, normal in faces]


def at_rest(pads: list[dict], weight: dict):
    return scene(
        5e-3,
        1e-3,
        mass=MASS,
        pads=pads,
        thrust=HELD,
        contact=PAPER_PAD,
        gravity={"x": 0.0, "y": 0.0, "z": 0.0} | weight,
        **SETTLED,
    )


def by_guide(run, faces) -> np.ndarray:
    """(n,g,3) force on each guide at the samples, in scene axes."""
    found = np.zeros((run.time.size, faces.guide.max() + 1, 3))
    np.add.at(found, (slice(None), faces.guide), run.pad_force)
    return found


def test_pads_share_the_weight_as_a_lever_does():
    """The mass centre is at a quarter of the way from the rear pads to the front ones. They sink by micrometres,
    so the payload tilts by some 1e-6."""
    run = lowfi.run(at_rest(FOUR, {"z": -G}), "springs")
    whole = MASS * G
    for guide, share in zip(run.guides, (0.375, 0.375, 0.125, 0.125), strict=True):
        assert guide.largest_force_n == pytest.approx(share * whole, abs=1e-5 * whole)
        assert guide.force_n == pytest.approx((0.0, 0.0, share * whole), abs=1e-4 * whole)
        assert guide.moment_n_m is None and guide.leaves_s is None
    assert [guide.name for guide in run.guides] == ["pad 1", "pad 2", "pad 3", "pad 4"]


def test_the_moment_of_a_button_is_that_of_the_weight_beside_it():
    """Under a weight across the slot each of two buttons has half of it, with the mass centre 100 mm above
    its foot: the foot takes half of the weight times 100 mm. Control: the force of the neck alone, 5.5 mm
    below the foot, has a moment of another size."""
    across = 0.02 * G
    pads = button(-0.1) + button(0.1)
    run = lowfi.run(at_rest(pads, {"y": -across, "z": -G}), "springs")
    assert [guide.name for guide in run.guides] == ["button 1", "button 2"]
    for guide, x in zip(run.guides, (-0.1, 0.1), strict=True):
        # in axes of the body, which tilts in the slot
        half = _turned(run.quaternion[0] * [1, -1, -1, -1], 0.5 * MASS * np.array([0.0, across, G]))
        np.testing.assert_allclose(guide.force_n, half, atol=1e-5)
        # the moments about the mass centre vanish: foot x force + moment = 0
        turning = np.cross((x, 0.0, -0.1), half) + guide.moment_n_m
        np.testing.assert_allclose(turning[0], 0.0, atol=1e-4)
        assert guide.moment_n_m[0] == pytest.approx(-0.1 * half[1], rel=1e-3)
        assert abs(guide.moment_n_m[0]) > 10.0 * 0.0055 * half[1]


@pytest.mark.parametrize("model", ["springs", "compliant"])
def test_the_largest_force_does_not_depend_on_the_samples(model):
    """It is that of samples 250 times as close. Control: the largest of the usual samples is not."""
    asked = REFERENCE.condition("phi35")
    under = {"compliance": reference_compliance()} if model == "compliant" else {}
    numerics = lowfi.Numerics(modes=4) if model == "compliant" else None
    faces = scene_model.build(asked).faces
    usual, fine = (
        lowfi.run(asked.replace({"output.interval": interval}), model, numerics=numerics, **under)
        for interval in (5e-4, 2e-6)
    )
    np.testing.assert_array_equal(usual.guide_force, fine.guide_force)
    np.testing.assert_array_equal(usual.guide_moment, fine.guide_moment)
    sizes, seen = (np.linalg.norm(by_guide(run, faces), axis=2) for run in (fine, usual))
    found, loaded = np.linalg.norm(usual.guide_force, axis=1), sizes.max(axis=0) > 1.0
    assert loaded.sum() >= 2
    np.testing.assert_allclose(found[loaded], sizes.max(axis=0)[loaded], rtol=1e-3)
    at = fine.time[sizes.argmax(axis=0)]
    np.testing.assert_allclose(usual.guide_time[loaded], at[loaded], atol=2e-5)
    assert (seen.max(axis=0)[loaded] < 0.98 * found[loaded]).any()


def test_the_force_has_the_impulse_that_changes_the_momentum():
    """Over the rail, on fixed rails: its integral and that of the thrust change the momentum."""
    asked = REFERENCE.condition("phi35").replace({"platform": None, "output.interval": 2e-6})
    run = lowfi.run(asked, "springs")
    last = int(np.searchsorted(run.time, run.outcome.exit_time))
    force = run.pad_force[: last + 1].sum(axis=1)
    pushed = np.trapezoid(force, run.time[: last + 1], axis=0)
    change = asked.payload.mass * (run.velocity[last] - run.velocity[0])
    size = thrust_law.sample(asked.thrust.record(), run.time[: last + 1])
    turn = run.to_xarray().quaternion.values[: last + 1]
    along = np.array([_turned(q, asked.thrust_offset.misalignment.direction()) for q in turn])
    given = np.trapezoid(size[:, None] * along, run.time[: last + 1], axis=0)
    assert np.abs(pushed[1:]).max() > 0.05
    np.testing.assert_allclose(pushed, change - given, atol=1e-3 * np.abs(pushed).max())


def _turned(q, vector):
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(q, scalar_first=True).apply(vector)


def test_feet_group_pads_and_a_pattern_has_none():
    pads = button(0.0)
    asked = at_rest([*pads, *FOUR], {"z": -G})
    guide = scene_model.build(asked).faces.guide
    assert guide.tolist() == [0] * 6 + [1, 2, 3, 4]
    with pytest.raises(SceneError, match="no such key with stations and corner"):
        at_rest({"stations": [0.0], "corner": [0.1, 0.1], "foot": [0.0, 0.0, 0.0]}, {})
