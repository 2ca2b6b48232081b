"""Walls that a file draws otherwise than straight: their offset, and what is refused."""

import numpy as np
import pytest

import tipoff
from tests.highfi.rail.test_own_rail import channels, from_file, saved
from tipoff import calibration, highfi, lowfi
from tipoff.calibration import Curves, rail_compliance
from tipoff.mechanics import drawn_walls
from tipoff.meshes import channel
from tipoff.scenes import SceneError, load

START, END = channels().rail.start, channels().rail.end


def drawn(folder, away):
    """The channels with every wall towards y moved away from the payload by ``away(x, z)`` (m)."""
    mesh = channel.build()
    x, y, z = mesh.points.T
    mesh.points[:, 1] += np.sign(y) * away(x, z)
    return from_file(channels(), saved(mesh, folder / "rails.msh"))


def draft(x, z):
    """From 0.1 mm outwards to 0.1 mm inwards."""
    return 1e-4 * (1.0 - 2.0 * (x - START) / (END - START))


def offsets(scene):
    return rail_compliance.walls(scene).drawn


def test_straight_walls_have_no_offset(tmp_path):
    """Nor those that a file format has rounded."""
    assert offsets(channels()) is None
    assert offsets(drawn(tmp_path, lambda x, z: 5e-10 * np.sin(1e3 * x))) is None
    assert rail_compliance.walls(load("tiny")) is None  # the built-in section has no file


def test_a_draft_is_found_to_rounding(tmp_path):
    scene = drawn(tmp_path, draft)
    found, x = offsets(scene), drawn_walls.grid(START, END)
    across = [face for face in range(found.shape[1]) if np.abs(found[:, face]).max() > 0.0]
    normals = [normal for pad in scene.pads for normal in pad.normals]
    assert across == [face for face, normal in enumerate(normals) if normal[1] == "y"]
    for face in across:
        assert found[:, face, 0] == pytest.approx(draft(x, 0.0), abs=1e-12, rel=0.0)
        assert np.abs(found[:, face, 1:]).max() < 1e-12


def test_a_wall_that_is_tilted_across_the_rail(tmp_path):
    """By 1 mrad: w_1 is the slope times half the width of the pad, and the clearance is somewhere on
    each wall."""
    scene = drawn(tmp_path, lambda x, z: 1e-3 * (np.abs(z) - 0.1) + 2.0 * draft(x, z))
    found = offsets(scene)
    half = 0.5e-3 * scene.pads[0].width
    tilt = np.abs(found[..., 1]).max(axis=0)
    assert tilt[tilt > 1e-9] == pytest.approx(half, rel=1e-9)


def test_the_compliance_holds_the_offset(tmp_path):
    """Of a stored one too, and its hash tells it from a straight rail."""
    scene = drawn(tmp_path, draft)
    found = highfi.condense(scene, 0.008, spacing=0.05, modes=0)
    assert found.drawn == pytest.approx(offsets(scene), abs=1e-15)
    found.save(tmp_path / "kept.npz")
    again = type(found).load(tmp_path / "kept.npz")
    np.testing.assert_array_equal(again.drawn, found.drawn)
    assert again.hash == found.hash


@pytest.mark.parametrize(
    "away, key, words",
    [
        (lambda x, z: 0.12 * np.abs(x - 0.02) - 0.006, "pads.", "slope"),
        (
            lambda x, z: (
                draft(x, z) + 3e-5 * (-1.0) ** np.unique(z.round(9), return_inverse=True)[1]
            ),
            "pads.",
            "parab",
        ),
        (lambda x, z: draft(x, z) + 3e-4, "rail.clearance", "0.00055 m"),
    ],
)
def test_what_is_no_offset_is_refused(tmp_path, away, key, words):
    with pytest.raises(SceneError) as caught:
        highfi.prepare(drawn(tmp_path, away))
    assert all(fault.key.startswith(key) for fault in caught.value.faults)
    assert words in str(caught.value)


def test_the_clearance_to_enter_does_not_depend_on_the_elements(tmp_path):
    """A wall of another clearance than the scene's everywhere. Control: a median of facets is that of
    the elements."""
    scene = drawn(tmp_path, lambda x, z: 3e-4 + draft(x, z) + 2e-3 * (x - START) ** 2)
    words = []
    for size in (0.004, 0.002):
        with pytest.raises(SceneError) as caught:
            highfi.prepare(scene, highfi.Numerics(element_size=size))
        words.append([fault.expected for fault in caught.value.faults])
    assert words[0] == words[1]


def jointed(folder, height, gap=0.0, joint=START + 0.052):
    """Drafted channels in two pieces that share no nodes: the second is ``height`` (m) nearer to the
    payload, and the first ends ``gap`` (m) before it."""
    mesh = channel.build()
    at = np.flatnonzero(np.abs(mesh.points[:, 0] - joint) < 1e-9)
    assert at.size  # a layer of elements ends there
    copy = np.arange(len(mesh.points))
    copy[at] = len(copy) + np.arange(at.size)
    mesh.points = np.concatenate([mesh.points, mesh.points[at]])
    second = np.zeros(len(mesh.points), dtype=bool)
    for block in mesh.cells:
        own = mesh.points[block.data][..., 0].mean(axis=1) > joint
        block.data[own] = copy[block.data[own]]
        second[block.data[own]] = True
    mesh.points[at, 0] -= gap
    x, y, _ = mesh.points.T
    mesh.points[:, 1] += np.sign(y) * (draft(x, 0.0) - height * second)
    return from_file(channels(), saved(mesh, folder / "rails.msh"))


@pytest.mark.parametrize("gap", [0.0, 2e-4])
@pytest.mark.parametrize("height", [2e-6, 1e-4, -1e-4])
def test_a_step_is_refused(tmp_path, height, gap):
    """Into the way of the pads and out of it: contact at an edge is not modelled, and energy would
    jump there. A ramp of the height is not refused. Control: nor is a joint without a step."""
    with pytest.raises(SceneError) as caught:
        highfi.prepare(jointed(tmp_path, height, gap))
    words = f"a step of {1e6 * abs(height):.3g} um at x = {START + 0.052 - gap:.6g} m"
    assert words in str(caught.value)
    highfi.prepare(jointed(tmp_path, 0.0, gap))

    def ramp(x, z):
        return draft(x, z) - height * np.clip((x - START - 0.052) / 6e-3, 0.0, 1.0)

    highfi.prepare(drawn(tmp_path, ramp))


@pytest.mark.parametrize("away", [None, draft], ids=["straight", "drawn"])
def test_springs_without_the_walls_of_a_file_are_refused(tmp_path, away):
    """They silently stood on straight walls, another answer than that of ``tipoff.run``. Nor does it
    depend on the walls of the file."""
    scene = channels() if away is None else drawn(tmp_path, away)
    time, rest = np.linspace(0.0, 0.04, 41), np.zeros((41, 3))
    curve = Curves(time, np.ones(41), rest, 0.02, np.zeros(3), "rest")
    for asked in (
        lambda: lowfi.run(scene, "springs"),
        lambda: lowfi.run_many(scene, [{}, {"payload.mass": 9.0}], "springs"),
        lambda: calibration.run(scene, {"phi15": curve}),
    ):
        with pytest.raises(SceneError) as caught:
            asked()
        (fault,) = caught.value.faults
        assert fault.key == "compliance" and "rail_compliance.walls(scene)" in fault.expected
    without = scene.replace({"contact": None, "friction": None})
    lowfi.models.require(without, "springs", None, None, None)  # nothing touches the walls
    lowfi.models.require(scene, "springs", rail_compliance.walls(scene), None, None)


def test_walls_of_another_rail_are_refused(tmp_path):
    """Straight ones too."""
    other = drawn(tmp_path, draft)
    for scene, given in ((other, channels()), (channels(), other)):
        with pytest.raises(SceneError, match="another rail, or other pads"):
            lowfi.run(scene, "springs", compliance=rail_compliance.walls(given))


def test_springs_on_straight_walls_of_a_file():
    """Those of the built-in section, from both doors."""
    scene = channels()
    walls = rail_compliance.walls(scene)
    runs = [lowfi.run(scene, "springs", compliance=walls), tipoff.run(scene, "springs")]
    assert runs[0].status == "exited"
    assert runs[0].outcome.rate == runs[1].outcome.rate
    same = scene.resolved()["rail"]
    section = scene.replace({"rail": {key: same[key] for key in ("start", "end", "material")}})
    assert lowfi.run(section, "springs").outcome.rate == runs[0].outcome.rate
