"""Rails in keyword files of LS-DYNA: in all formats of its fields, with surfaces named in all ways."""

import numpy as np
import pytest

from tests.formats.meshes import lsdyna_text, seeds
from tests.formats.meshes.test_mesh_files import WHOLE, areas, check_rail, lowest, read_text
from tests.highfi.mesh.test_file_elements import plate
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.meshes import generator

FORMS = (lsdyna_text.STANDARD, lsdyna_text.I10, lsdyna_text.LONG, lsdyna_text.FREE)


@pytest.mark.parametrize("two_lines", [False, True])
@pytest.mark.parametrize("form", FORMS)
def test_fields_of_every_format(tmp_path, form, two_lines):
    check_rail(read_text(tmp_path, lsdyna_text.text(form, two_lines=two_lines), "rail.k"))


@pytest.mark.parametrize("surfaces", ["segments", "nodes", "shells", "parts", "sets of parts"])
@pytest.mark.parametrize("suffix", ["k", "key", "dyn"])
def test_surfaces_named_in_every_way(tmp_path, surfaces, suffix):
    text = lsdyna_text.text(surfaces=surfaces)
    check_rail(read_text(tmp_path, text, f"rail.{suffix}"))
    check_rail(read_text(tmp_path, text.replace("\nmount\n", "\nMOUNT\n"), f"capitals.{suffix}"))


def test_it_is_the_rail_of_the_other_formats(tmp_path):
    """Nodes, elements and the lowest frequency are equal. Control: a mount that lost a node of its
    set is softer."""
    first = read(seeds.write("gmsh 2.2 text", tmp_path / "first"))
    second = read_text(tmp_path, lsdyna_text.text(surfaces="nodes"), "rail.k")
    np.testing.assert_allclose(second.points, first.points, atol=1e-12)
    np.testing.assert_array_equal(second.cells, first.cells)
    assert lowest(second) == pytest.approx(lowest(first), rel=1e-9)
    # Control.
    lines = lsdyna_text.text(surfaces="nodes").split("\n")
    place = lines.index("mount") + 2
    lines[place] = lines[place][:-10]
    assert lowest(read_text(tmp_path, "\n".join(lines), "less.k")) < 0.999 * lowest(first)


def test_one_keyword_may_have_a_format_of_its_own(tmp_path):
    """A plus behind the keyword; a minus in a file of long format."""
    long = lsdyna_text.text(lsdyna_text.LONG).split("\n")
    mixed, start = lsdyna_text.text().split("\n"), long.index("*NODE")
    end = long.index("*PART")
    mixed[start:end] = ["*NODE +", *long[start + 1 : end]]
    check_rail(read_text(tmp_path, "\n".join(mixed), "rail.k"))
    long[start:end] = ["*NODE-", *lsdyna_text.text().split("\n")[start + 1 : end]]
    check_rail(read_text(tmp_path, "\n".join(long), "rail.k"))


@pytest.mark.parametrize(
    "before, after",
    [
        ("*ELEMENT_SOLID", "*ELEMENT_SOLID (ten nodes format)"),  # as LS-PrePost writes it
        ("*ELEMENT_SOLID", "*element_solid"),
        ("*PART", "*MAT_ELASTIC\n1,2810.,&modulus,.33\n*PARAMETER\nR modulus 72.e9\n*PART"),
        ("*PART", "*SET_NODE_GENERAL\n9\nALL\n*DEFINE_TRANSFORMATION\n1\nSCALE,2.\n*PART"),
        ("*PART", "*ELEMENT_BEAM\n       1       9       1       2       3\n*PART"),
    ],
)
def test_what_else_a_deck_may_have(tmp_path, before, after):
    text = lsdyna_text.text(two_lines=True)
    assert before in text
    check_rail(read_text(tmp_path, text.replace(before, after, 1), "rail.k"))


@pytest.mark.gmsh
@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "tetra", "tetra10"])
def test_a_rail_as_gmsh_writes_it(tmp_path, kind):
    """gmsh writes sets of nodes with their names in comments. Tetrahedra of 4 nodes are bricks with
    repeated nodes. Control: comments with the names of columns are no names of sets."""
    with generator.session("plate") as gmsh:
        plate(gmsh, kind)
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        gmsh.write(str(tmp_path / "plate.key"))
        gmsh.write(str(tmp_path / "plate.msh"))
    text = (tmp_path / "plate.key").read_text()
    assert "*SET_NODE_LIST\n$# mount" in text
    mesh = read(tmp_path / "plate.key")
    own = read(tmp_path / "plate.msh")
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-9)
    assert len(mesh.points) == len(own.points) and len(mesh.cells) == len(own.cells)
    assert lowest(mesh) == pytest.approx(lowest(own), rel=1e-9)
    with pytest.raises(MeshError, match="groups in the mesh: contact, node set 1, "):
        read_text(tmp_path, text.replace("$# mount", "$#     sid       da1"), "columns.key")


TETRAHEDRON = """*KEYWORD
*NODE
1,0,0,0
2,1,0,0
3,0,1,0
4,0,0,1
5,.5,0,0
6,.5,.5,0
7,0,.5,0
8,0,0,.5
9,.5,0,.5
10,0,.5,.5
*ELEMENT_SOLID
{}
*SET_SEGMENT_TITLE
mount
1
1,3,2,2
*SET_SEGMENT_TITLE
contact
2
1,2,4,0
"""


@pytest.mark.parametrize(
    "element",
    [
        "1,1,1,2,3,4,4,4,4,4",
        "1,1\n1,2,3,4,4,4,4,4,0,0",
        "1,1\n1,2,3,4,5,6,7,8,9,10",
        "       1       1\n       1       2       3       4       5       6       7       8       9      10",
    ],
)
def test_tetrahedra_in_one_line_and_in_two(tmp_path, element):
    mesh = read_text(tmp_path, TETRAHEDRON.format(element), "rail.k")
    assert mesh.cells.shape == (1, 10)
    assert areas(mesh) == pytest.approx({"mount": 0.5, "contact": 0.5})


@pytest.mark.parametrize(
    "before, after, why",
    [
        (
            "*PART",
            "*INCLUDE_TRANSFORM\nother.k\n*PART",
            r"\*INCLUDE_TRANSFORM is not read; write one",
        ),
        ("*PART", "*NODE_TRANSFORM\n*PART", r"\*NODE_TRANSFORM is not read"),
        ("*ELEMENT_SOLID", "*ELEMENT_SOLID_ORTHO", r"\*ELEMENT_SOLID_ORTHO is not read; write"),
        ("*END", "*ELEMENT_SHELL_COMPOSITE", r"\*ELEMENT_SHELL with COMPOSITE is not read"),
        (
            "*SET_SEGMENT_TITLE",
            "*SET_SEGMENT_GENERAL_TITLE",
            "GENERAL_TITLE is not read; write 'mou",
        ),
        ("*END", "*ELEMENT_SOLID\n1,7,1,2,3,4,5,6,7,9", "a second element 1"),
        ("*END", "*ELEMENT_SOLID\n99,7", r"the last element lacks nodes"),
        (
            "*END",
            "*ELEMENT_SOLID\n99,7,1,2,3,4,1,2,3,4",
            "a solid with 8 nodes, 4 of them different",
        ),
        ("*END", "*ELEMENT_SOLID\n99,7,1,2,3,4,5,6,7,77", "no coordinates for nodes 77"),
        (
            "*END",
            "*ELEMENT_SOLID\n99,7,1,2,3,4,5,5,6,6",
            "solid elements of other types: wedge; .* are read: mesh the rail with one of them",
        ),
        ("*END", "*NODE\n1,5.,5.,5.", "two places for nodes 1"),
        ("*END", "*NODE\n99,&x,5.,5.", "'&x' in place of a number"),
        ("*END", "*SET_NODE_LIST_GENERATE\n1\n9,3", "a range from 9 to 3"),
        ("*END", "*SET_SEGMENT\n1\n9,3,0,0", "2 different corners"),
        ("$ a rail", "5 1 0 0", "line 1: data before the first keyword"),
        ("*NODE\n", "*NODES\n", r"no \*NODE, which a keyword file of LS-DYNA has"),
    ],
)
def test_what_a_file_gets_wrong_is_named(tmp_path, before, after, why):
    text = lsdyna_text.text()
    assert before in text
    after += "\n*END" * (before == "*END")
    with pytest.raises(MeshError, match=f"rail.k cannot be used:.*\n?.*{why}") as caught:
        read_text(tmp_path, text.replace(before, after, 1), "rail.k")
    assert str(caught.value).endswith("section 'Meshes of rails'")
