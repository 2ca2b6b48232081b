"""A rail given as a file: how it is chosen, and that its content counts."""

import pytest

from tests.scenes.support import CONTACT, SMALL, small
from tipoff.calibration import parameters
from tipoff.scenes import SceneError, load, parse, scene_model
from tipoff.scenes.rail import MeshTable, SectionTable

MATERIAL = SMALL["rail"]["material"]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "rail.msh"
    path.write_bytes(b"a mesh")
    return path


def meshed(file, **keys) -> dict:
    """The small scene with a rail given as a file."""
    return small(
        rail={"start": "-0.1 m", "end": "0.1 m", "material": MATERIAL, "mesh": str(file)} | keys
    )


def scene_file(folder, text, name="scene.toml"):
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


RAIL = """[rail]
mesh = "rail.msh"
start = "-0.1 m"
end = "0.1 m"
material = { density = "2810 kg/m**3", youngs_modulus = "72 GPa", poisson_ratio = 0.33 }
"""


def test_a_sharp_section_has_the_hash_of_scenes_without_the_key():
    """The largest fillets are taken in any unit."""
    sharp = parse(small())
    assert "fillet" not in sharp.physics()["rail"] and sharp.rail.fillet is None
    found = {parse(small(rail__fillet=radius)).hash for radius in ("5 mm", "0.5 cm", "5000 um")}
    assert len(found) == 1 and sharp.hash not in found
    assert sharp.replace({"rail.fillet": "1 mm"}).replace({"rail.fillet": None}).hash == sharp.hash


def test_presence_of_a_file_is_the_switch(file):
    assert isinstance(parse(small()).rail, SectionTable)
    assert isinstance(parse(meshed(file)).rail, MeshTable)


def test_a_file_counts_by_its_content_not_by_its_place(file, tmp_path):
    elsewhere, changed = tmp_path / "same.msh", tmp_path / "changed.msh"
    elsewhere.write_bytes(b"a mesh")
    changed.write_bytes(b"a mesh, one node moved")
    hashes = [parse(meshed(path)).hash for path in (file, elsewhere, changed)]
    assert hashes[0] == hashes[1] != hashes[2]
    assert parse(small()).hash not in hashes


def test_a_file_that_changes_later_is_noticed(file):
    scene = parse(meshed(file))
    before = scene.hash
    assert scene.rail.is_as_found()
    file.write_bytes(b"another")
    assert scene.hash == before and not scene.rail.is_as_found()
    assert parse(meshed(file)).hash != before


def test_results_write_it_and_read_it_back(file):
    scene = parse(meshed(file, leg="20 mm"))
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    assert scene.replace({"rail.end": "0.2 m"}).rail.end == 0.2


def test_the_file_lies_beside_the_scene_that_names_it(file, tmp_path, monkeypatch):
    """And it replaces an inherited section whole: mixed, the leg of the section would pass for that
    of the file."""
    scene_file(tmp_path, f'extends = "reference"\n{RAIL}', "base.toml")
    monkeypatch.chdir("/")
    found = load(scene_file(tmp_path, 'extends = "base.toml"\n[rail]\nend = "0.2 m"\n'))
    assert (found.rail.path(), found.rail.end, found.rail.leg) == (file, 0.2, None)


def test_back_to_the_section(file, tmp_path):
    scene_file(tmp_path, f'extends = "reference"\n{RAIL}', "base.toml")
    found = load(
        scene_file(tmp_path, 'extends = "base.toml"\n[rail]\nmesh = "absent"\nleg = "30 mm"\n')
    )
    assert isinstance(found.rail, SectionTable) and found.rail.leg == 0.03


def test_a_calibration_needs_the_lengths_of_its_bounds(file):
    bare = parse(meshed(file) | {"contact": CONTACT})
    with pytest.raises(SceneError) as caught:
        parameters.free(bare)
    assert [fault.key for fault in caught.value.faults] == ["rail.leg", "rail.thickness"]
    assert parameters.free(bare.replace({"rail.leg": 0.024, "rail.thickness": 0.004}))


@pytest.mark.parametrize("clearance", ["0.1 mm", "0.3 mm"])
def test_walls_of_a_file_stay_and_pads_meet_them_at_the_clearance(file, clearance):
    """Drawn for 0.2 mm; in the built-in rail the pads stay and the walls move."""
    contact = {"contact": CONTACT | {"clearance": clearance}}
    own, built = (parse(raw | contact) for raw in (meshed(file, clearance="0.2 mm"), small()))
    for scene, wall, pad in (
        (own, 0.1002, 0.1002 - own.contact.clearance),
        (built, 0.1 + own.contact.clearance, 0.1),
    ):
        faces = scene_model.build(scene).faces
        assert faces.wall == pytest.approx(wall, rel=1e-12)
        assert faces.centre[[0, 1], faces.axis] == pytest.approx(pad, rel=1e-12)
