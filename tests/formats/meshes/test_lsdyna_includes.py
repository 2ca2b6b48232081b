"""Keyword files of LS-DYNA in several files: the rail is that of one file, faults name the included
file, and the key of a mesh contains the content of all of them."""

import numpy as np
import pytest

from tests.formats.meshes import lsdyna_text
from tests.formats.meshes.test_mesh_files import check_rail, read_text
from tests.scenes.support import refused, small
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.highfi.rail.geometry import geometry
from tipoff.scenes import parse

RAIL = {"start": "-88 mm", "end": "132 mm"} | {
    "material": {"density": "2810 kg/m**3", "youngs_modulus": "72 GPa", "poisson_ratio": 0.33}
}


def parts(form=lsdyna_text.STANDARD) -> tuple[str, str, str]:
    """The lines of a rail before the first set, the sets, and the end."""
    text = lsdyna_text.text(form)
    place = text.index("*SET_")
    return text[:place], text[place : text.index("*END")], "*END\n"


def written(folder, files: dict[str, str]):
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder / "rail.k"


@pytest.mark.parametrize("form", [lsdyna_text.STANDARD, lsdyna_text.LONG])
@pytest.mark.parametrize(
    "top, name",
    [
        ("*INCLUDE\n$ sets\nsets.k\n", "sets.k"),
        ("*INCLUDE\nparts\\sets.k\n", "parts/sets.k"),
        ("*INCLUDE\nparts/ +\nsets.k\n", "parts/sets.k"),
        ("*INCLUDE_PATH\nparts\n*INCLUDE\nsets.k\n", "parts/sets.k"),
        ("*include_path_relative\nparts\n*include\nsets.k\n", "parts/sets.k"),
    ],
)
def test_a_rail_in_two_files(tmp_path, form, top, name):
    """It has the format of the file that includes it, and an end of its own."""
    head, sets, end = parts(form)
    path = written(tmp_path, {"rail.k": head + top + end, name: f"{sets}*END\nnothing"})
    check_rail(read(path))
    whole = read_text(tmp_path, lsdyna_text.text(form), "whole.k")
    np.testing.assert_array_equal(read(path).cells, whole.cells)
    np.testing.assert_array_equal(read(path).points, whole.points)


def test_names_count_from_the_including_file_then_from_the_first(tmp_path):
    head, sets, end = parts()
    files = {"rail.k": f"{head}*INCLUDE\na/one.k\n{end}", "a/one.k": "*INCLUDE\ntwo.k\ntop.k\n"}
    files |= {"a/two.k": sets, "two.k": "*NOTHING\nno file of a keyword", "top.k": "$ nothing\n"}
    check_rail(read(written(tmp_path, files)))


def test_a_file_has_a_format_of_its_own(tmp_path):
    """Long nodes below a header; the file that includes it goes on in its format."""
    head, sets, end = parts()
    place, after = head.index("*NODE"), head.index("*PART")
    long = lsdyna_text.text(lsdyna_text.LONG)
    nodes = "*KEYWORD LONG=Y\n" + long[long.index("*NODE") : long.index("*PART")]
    text = f"{head[:place]}*INCLUDE\nnodes.key\n{head[after:]}{sets}{end}"
    check_rail(read(written(tmp_path, {"rail.k": text, "nodes.key": nodes})))


@pytest.mark.parametrize(
    "included, why",
    [
        ({}, r"rail.k, line \d+: \*INCLUDE names sets.k, which is not beside it and in no folder"),
        ({"sets.k": "*INCLUDE\nrail.k\n"}, r"sets.k, line 1: \*INCLUDE names rail.k, .* a circle"),
        ({"sets.k": "*INCLUDE\nsets.k\n"}, r"sets.k, line 1: \*INCLUDE names sets.k, .* a circle"),
        (
            {"sets.k": "*INCLUDE\nb.k\nb.k\n", "b.k": "$\n"},
            r"sets.k, line 1: \*INCLUDE names b.k, which is included already",
        ),
        ({"sets.k": "*TITLE\na\n*NODE\n99,x,0,0\n"}, r"sets.k, line 4: 'x' in place of a number"),
        ({"sets.k": "5 1\n"}, "sets.k, line 1: data before the first keyword"),
        ({"sets.k": "*INCLUDE_TRANSFORM\nb.k\n"}, r"\*INCLUDE_TRANSFORM is not read; write"),
    ],
)
def test_faults_name_the_file_and_the_line(tmp_path, included, why):
    head, _, end = parts()
    files = {"rail.k": f"{head}*INCLUDE\nsets.k\n{end}"} | included
    with pytest.raises(MeshError, match=f"rail.k cannot be used: .*{why}") as caught:
        read(written(tmp_path, files))
    assert str(caught.value).count("\n") == 1  # and the page


def test_a_scene_refuses_a_missing_file(tmp_path):
    path = written(tmp_path, {"rail.k": "*NODE\n*INCLUDE\nsets.k\n"})
    (fault,) = refused(small(rail=RAIL | {"mesh": str(path)}))
    assert fault.key == "rail.mesh"
    assert "a readable file (rail.k, line 2: *INCLUDE names sets.k" in fault.expected


def test_the_key_of_a_mesh_has_the_content_of_included_files(tmp_path):
    """Control: the content of the first file does not change. A file that is not included does not
    matter."""
    head, sets, end = parts()
    files = {"rail.k": f"{head}*INCLUDE\na.k\n{end}", "a.k": "*INCLUDE\nb.k\n", "b.k": sets}
    path = written(tmp_path, files)
    table = small(rail=RAIL | {"mesh": str(path)})
    scene = parse(table)
    first = path.read_bytes()
    (tmp_path / "c.k").write_text("another")
    assert scene.rail.is_as_found() and geometry(parse(table)) == geometry(scene)
    (tmp_path / "b.k").write_text(sets + "$ a comment\n")
    assert path.read_bytes() == first  # Control
    assert not scene.rail.is_as_found()
    assert parse(table).hash != scene.hash
    assert geometry(parse(table)) != geometry(scene)
