"""``[rail] section``: how it is chosen, and that the content of a drawing counts."""

import copy

import pytest

from tests.formats.sections.test_dxf import drawing, polyline
from tests.scenes.section_shapes import T_SLOT
from tests.scenes.support import SMALL, small
from tipoff.scenes import SceneError, load, parse
from tipoff.scenes.profile_rail import ProfileTable

RAIL = {
    "start": "-0.1 m",
    "end": "0.1 m",
    "material": SMALL["rail"]["material"],
    "mounts": [{"start": "0 mm", "end": "20 mm"}],
    "mounted": [["15 mm", "-20 mm"]],
}
SLOTTED = {key: value if key == "shape" else f"{value} m" for key, value in T_SLOT.items()}


def scene(**keys):
    """The small scene with such a rail."""
    return parse(small(rail=copy.deepcopy(RAIL) | {"section": SLOTTED} | keys))


def test_a_section_is_chosen_by_its_key_and_survives_a_result_file():
    first = scene(at=["0 mm", "-60 mm"], mirrored=["z"])
    assert isinstance(first.rail, ProfileTable)
    again = parse(first.resolved(), bare_numbers_are_si=True)
    assert again.hash == first.hash and again.rail.outline() == first.rail.outline()
    assert scene().hash != first.hash


def test_corners_and_shapes_are_overridden_by_dotted_keys():
    wider = scene().replace({"rail.section.slot": "9 mm"})
    assert wider.rail.section.slot == pytest.approx(0.009)
    assert wider.rail.outline() != scene().rail.outline()
    square = [["0 mm", "0 mm"], ["20 mm", "0 mm"], ["20 mm", "20 mm"], ["0 mm", "20 mm"]]
    own = scene(section=square, mounted=[["10 mm", "0 mm"]])
    assert own.replace({"rail.section.1.0": "30 mm"}).rail.outline().moments().area > 4.9e-4


def test_a_drawing_counts_by_its_content(tmp_path):
    path, moved = tmp_path / "rail.dxf", tmp_path / "other.dxf"
    path.write_text(drawing(polyline((0, 0), (20, 0), (20, 20), (0, 20))))
    moved.write_text(path.read_text())
    keys = {"mounted": [["10 mm", "0 mm"]]}
    first = scene(section=str(path), **keys)
    assert scene(section=str(moved), **keys).hash == first.hash
    path.write_text(drawing(polyline((0, 0), (20, 0), (20, 30), (0, 30))))
    assert scene(section=str(path), **keys).hash != first.hash
    with pytest.raises(SceneError, match="it has changed, read the scene again"):
        first.replace({"payload.mass": "11 kg"})


def test_a_drawing_is_beside_the_file_of_its_scene_and_replaces_an_inherited_rail(tmp_path):
    (tmp_path / "rail.dxf").write_text(drawing(polyline((0, 0), (20, 0), (20, 20), (0, 20))))
    (tmp_path / "scene.toml").write_text(
        """extends = "tiny"
[rail]
section = "rail.dxf"
start = "-88 mm"
end = "132 mm"
mounts = [{ start = "0 mm", end = "20 mm" }]
mounted = [["10 mm", "0 mm"]]
material = { density = "2700 kg/m**3", youngs_modulus = "70 GPa", poisson_ratio = 0.33 }
"""
    )
    found = load(tmp_path / "scene.toml").rail
    assert found.section == str(tmp_path / "rail.dxf") and len(found.outline().loops) == 1


def test_a_free_end_that_is_far_softer_than_the_rail_between_mounts_is_implausible():
    spans = [{"start": "0 mm", "end": "10 mm"}, {"start": "30 mm", "end": "40 mm"}]
    assert any("at the open end are not held" in text for text in scene(mounts=spans).warnings)
