"""Rails in universal files, MED files and files of VTK, written by gmsh, by meshio or as text."""

import meshio
import numpy as np
import pytest

from tests.formats.meshes import forms
from tests.formats.meshes.test_mesh_files import WHOLE, areas, check_rail, lowest, read_text
from tests.highfi.mesh.test_file_elements import plate
from tipoff.highfi.mesh.asked import Asked
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.meshes import generator

KINDS = ["hexahedron", "hexahedron20", "tetra", "tetra10"]


@pytest.mark.gmsh
@pytest.mark.parametrize(
    "suffix, kind",
    [(each, kind) for each in ("unv", "med") for kind in KINDS] + [("med", "hexahedron27")],
)
def test_a_rail_as_gmsh_writes_it(tmp_path, suffix, kind):
    """Nodes, elements and the lowest frequency are those of gmsh's own format."""
    with generator.session("plate") as gmsh:
        plate(gmsh, kind)
        for each in (suffix, "msh"):
            gmsh.write(str(tmp_path / f"plate.{each}"))
    mesh, own = (read(tmp_path / f"plate.{each}") for each in (suffix, "msh"))
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-9)
    np.testing.assert_allclose(_sorted(mesh.points), _sorted(own.points), atol=1e-12)
    assert len(mesh.cells) == len(own.cells)
    assert lowest(mesh) == pytest.approx(lowest(own), rel=1e-9)


def _sorted(points):
    return np.unique(np.round(points, 12) + 0.0, axis=0)


@pytest.mark.gmsh
@pytest.mark.parametrize("suffix", ["unv", "med"])
def test_groups_of_nodes_as_gmsh_writes_them(tmp_path, suffix):
    """Beside the surface elements of the same names."""
    with generator.session("plate") as gmsh:
        plate(gmsh, "hexahedron")
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        gmsh.write(str(tmp_path / f"plate.{suffix}"))
    mesh = read(tmp_path / f"plate.{suffix}")
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-9)


@pytest.mark.parametrize("code", ["2467", "2477", "2452", "2435", "2432", "2430", "2429", "2417"])
@pytest.mark.parametrize("shells", [True, False])
def test_groups_of_universal_files(tmp_path, shells, code):
    check_rail(read_text(tmp_path, forms.universal(shells, code), "rail.unv"))


SYSTEM = "    -1\n  2420\n         1\nname\n         1         {}         8\nglobal\n{}    -1\n"
UNIT = "    1.0 0.0 0.0\n    0.0 1.0 0.0\n    0.0 0.0 1.0\n    {} 0.0 0.0\n"


@pytest.mark.parametrize(
    "before, after, why",
    [
        ("  2411\n", "  2412\n", "no dataset 2411|line "),
        ("       115", "       117", "elements of descriptor 117 with 8 nodes"),
        ("       115", "       116", "8 nodes in place of 20"),
        ("         1       115", "         1       115x", "in place of an integer"),
        ("         2       115", "         1       115", "a second element 1"),
        ("    -1\n    -1\n  2412", SYSTEM.format(0, UNIT.format(1.0)), "system 1 is turned, moved"),
        ("    -1\n    -1\n  2412", SYSTEM.format(1, UNIT.format(0.0)), "system 1 is turned, moved"),
        (
            "         0         0         8\nmount",
            "         0         0       800\nmount",
            "'contact' in place of an integer",
        ),
        ("D-0", "x", "in place of a number"),
    ],
)
def test_what_a_universal_file_gets_wrong_is_named(tmp_path, before, after, why):
    text = forms.universal()
    assert before in text
    if before.startswith("    -1"):
        after = "    -1\n" + after + before.removeprefix("    -1\n")
    with pytest.raises(MeshError, match=f"as a file of I-deas: .*({why})"):
        read_text(tmp_path, text.replace(before, after, 1), "rail.unv")


def test_a_global_system_is_accepted(tmp_path):
    text = forms.universal().replace(
        "    -1\n    -1\n  2412", "    -1\n" + SYSTEM.format(0, UNIT.format(0.0)) + "    -1\n  2412"
    )
    check_rail(read_text(tmp_path, text, "rail.unv"))
    with pytest.raises(MeshError, match="dataset 2467 has no end"):
        read_text(tmp_path, forms.universal().rstrip()[:-6], "rail.unv")


@pytest.mark.parametrize("name", ["rail.vtu", "rail.vtk"])
@pytest.mark.parametrize("options", [{}, {"binary": False}])
@pytest.mark.parametrize("groups", [{}, {"mount": ("part = 1",), "contact": ("Part = 2",)}])
def test_arrays_of_vtk_are_groups(tmp_path, name, options, groups):
    """By marks of cells and of points, and by values of an array."""
    writer = meshio.vtu.write if name.endswith("u") else meshio.vtk.write
    writer(tmp_path / name, forms.tagged(), **options)
    check_rail(read(tmp_path / name, Asked(groups=groups)))
    with pytest.raises(MeshError, match="no group 'part = 9'"):
        read(tmp_path / name, Asked(groups={"mount": ("part = 9",)}))


def test_a_file_of_med_that_meshio_writes(tmp_path):
    """Which does not turn the faces of solids, as gmsh and Salome do."""
    forms.write("MED", tmp_path / "rail")
    check_rail(read(tmp_path / "rail.med"))
    check_rail(read(tmp_path / "rail.med", Asked(body="rail", groups={"contact": ("end",)})))


@pytest.mark.parametrize(
    "name, content, why",
    [
        ("rail.med", b"no HDF5", "as a file of Salome: it is damaged or no MED file"),
        ("rail.vtu", b"<VTKFile", "as a file of VTK: meshio does not read it"),
        ("rail.vtk", b"", "as a file of VTK: meshio does not read it"),
        ("rail.unv", b"    -1\n", "no dataset 2411"),
        ("rail.step", b"", "a solid: give it as rail.geometry"),
        ("rail.stl", b"", "a rail needs solid elements"),
        ("rail.cdb", b"", "a file of Ansys: export .inp"),
        ("rail.hm", b"", "a data base of HyperMesh"),
        ("rail.odb", b"", "write its input file, .inp"),
        ("rail.k.gz", b"", "a packed file: unpack it"),
        ("rail.cgns", b"", "let the mesh generator write one of these"),
    ],
)
def test_a_file_that_is_none_is_refused_with_a_remedy(tmp_path, name, content, why):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MeshError, match=why) as caught:
        read(tmp_path / name)
    assert len(str(caught.value).splitlines()) == 2


POLYHEDRON = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1"><Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray>
</Points><Cells>
<DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="Int32" Name="types" format="ascii">42</DataArray>
<DataArray type="Int32" Name="faces" format="ascii">4 3 0 1 2 3 0 1 3 3 1 2 3 3 0 2 3</DataArray>
<DataArray type="Int32" Name="faceoffsets" format="ascii">17</DataArray>
</Cells></Piece></UnstructuredGrid></VTKFile>
"""


def test_polyhedra_are_refused(tmp_path):
    with pytest.raises(MeshError, match="polyhedra, which are not read"):
        read_text(tmp_path, POLYHEDRON, "rail.vtu")


def test_hdf5_without_the_parts_of_med_is_refused(tmp_path):
    import h5py

    with h5py.File(tmp_path / "rail.med", "w") as file:
        file.create_group("ENS_MAA/a/NOE")
    with pytest.raises(MeshError, match="it is damaged or no MED file"):
        read(tmp_path / "rail.med")
    with h5py.File(tmp_path / "rail.med", "a") as file:
        file.create_group("ENS_MAA/b")
    with pytest.raises(MeshError, match="2 meshes in one file, a, b; write the rail alone"):
        read(tmp_path / "rail.med")
