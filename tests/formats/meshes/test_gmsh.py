"""Files of gmsh with groups that have no name, and with nodes that have coordinates on their entities."""

import re

import pytest

from tests.formats.meshes import seeds
from tests.formats.meshes.test_mesh_files import WHOLE, areas, check_rail, plate, read_text
from tipoff.highfi.mesh.asked import Asked
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.meshes import generator


@pytest.mark.parametrize("form", ["gmsh 2.2 text", "gmsh 4.1 binary"])
def test_groups_of_gmsh_without_a_name_have_that_of_their_number(tmp_path, form):
    """Control: a name that is not there."""
    content = seeds.write(form, tmp_path / "rail").read_bytes()
    numbers = {
        name.decode(): int(tag)
        for tag, name in re.findall(rb'^2 (\d+) "(.*)"\r?$', content, re.MULTILINE)
    }
    bare = re.sub(rb"\$PhysicalNames.*\$EndPhysicalNames\r?\n", b"", content, flags=re.DOTALL)
    (tmp_path / "bare.msh").write_bytes(bare)
    groups = {name: (f"surface {numbers[name]}",) for name in ("mount", "contact")}
    check_rail(read(tmp_path / "bare.msh", Asked(groups=groups)))
    with pytest.raises(MeshError):
        read(tmp_path / "bare.msh")
    empty = re.sub(rb'^(\d \d+) ".*"', rb'\1 ""', content, flags=re.MULTILINE)
    assert empty != content
    (tmp_path / "empty.msh").write_bytes(empty)
    check_rail(read(tmp_path / "empty.msh", Asked(groups=groups)))


def test_parametric_nodes_are_nodes(tmp_path):
    """A node on a curve has one more coordinate, one on a surface two, one at a point none."""
    text = seeds.write("gmsh 2.2 text", tmp_path / "rail").read_text()
    before, nodes, after = re.split(r"\$(?:End)?Nodes\n", text)
    count, *lines = nodes.splitlines()
    ends = (" 0 1", " 1 2 0.5", " 2 3 0.25 0.75", " 3 1")
    longer = "".join(f"{line}{ends[k % 4]}\n" for k, line in enumerate(lines))
    name = "ParametricNodes"
    made = read_text(tmp_path, f"{before}${name}\n{count}\n{longer}$End{name}\n{after}", "rail.msh")
    check_rail(made)
    with pytest.raises(MeshError, match=".ParametricNodes has .* in place of an integer"):
        read_text(tmp_path, f"{before}${name}\n{count}\n{nodes}$End{name}\n{after}", "b.msh")


@pytest.mark.gmsh
@pytest.mark.parametrize("binary", [0, 1])
def test_parametric_nodes_as_gmsh_writes_them(tmp_path, binary):
    with generator.session("plate") as gmsh:
        plate(gmsh)
        gmsh.option.setNumber("Mesh.SaveParametric", 1)
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(tmp_path / "plate.msh"))
        gmsh.option.setNumber("Mesh.SaveParametric", 0)
    assert b"$ParametricNodes" in (tmp_path / "plate.msh").read_bytes()
    assert areas(read(tmp_path / "plate.msh")) == pytest.approx(WHOLE, rel=1e-9)
