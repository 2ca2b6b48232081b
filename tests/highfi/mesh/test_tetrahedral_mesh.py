"""Meshes of ten-node tetrahedra: read as gmsh writes them, and every fault named by element
number."""

from types import SimpleNamespace

import meshio
import numpy as np
import pytest

from tests.highfi import tets
from tests.highfi.blocks import ALUMINIUM, block
from tipoff.highfi.elements import tetrahedron
from tipoff.highfi.mesh import cells, facets
from tipoff.highfi.mesh.rail_mesh import MeshError, along_x, boundary_facets, read
from tipoff.highfi.rail.step_cost import with_sliver_steps
from tipoff.meshes import generator, msh


def write_drilled(path, version=2.2, order=2):
    """A brick of 20 x 10 x 5 mm with a hole of 4 mm through it, meshed and named in gmsh itself, as
    a user would."""
    with generator.session("brick") as gmsh:
        tool = gmsh.model.occ.addCylinder(0.01, 0.005, -1e-3, 0.0, 0.0, 7e-3, 0.002)
        gmsh.model.occ.cut(
            [(3, gmsh.model.occ.addBox(0.0, 0.0, 0.0, 0.020, 0.010, 0.005))], [(3, tool)]
        )
        gmsh.model.occ.synchronize()
        sides = {
            tuple(np.round(gmsh.model.occ.getCenterOfMass(2, tag), 6)): tag
            for _, tag in gmsh.model.getEntities(2)
        }
        gmsh.model.addPhysicalGroup(2, [sides[0.01, 0.005, 0.005]], name="contact_top")
        gmsh.model.addPhysicalGroup(
            2, [sides[0.0, 0.005, 0.0025], sides[0.02, 0.005, 0.0025]], name="mount"
        )
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="rail")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.0025)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    return path


@pytest.mark.gmsh
@pytest.mark.parametrize("version", [2.2, 4.1])
def test_second_order_files_of_gmsh_are_read(tmp_path, version):
    mesh = read(write_drilled(tmp_path / "drilled.msh", version))
    assert mesh.cells.shape[1] == 10 and {facets.shape[1] for facets in mesh.surfaces.values()} == {
        6
    }
    # Quadratic edges, twelve to a circle, miss it by 1e-4 of its area.
    _, area = facets.gauss(mesh.points[mesh.surfaces["contact_top"]], 4)
    assert area.sum() == pytest.approx(0.02 * 0.01 - np.pi * 0.002**2, rel=2e-5)
    _, area = facets.gauss(mesh.points[mesh.surfaces["mount"]], 2)
    assert area.sum() == pytest.approx(2 * 0.01 * 0.005, rel=1e-12)
    jacobian, scaled = cells.jacobians(mesh.points, mesh.cells)
    assert jacobian.min() > 0.0 and 0.0 < scaled.min() < scaled.max() < 1.5
    outward = facets.normals(mesh.points[mesh.surfaces["contact_top"]])
    assert outward == pytest.approx(np.tile([0.0, 0.0, 1.0], (len(outward), 1)), abs=1e-9)


@pytest.mark.gmsh
def test_numbering_from_end_to_end_changes_nothing_else(tmp_path):
    mesh = read(write_drilled(tmp_path / "drilled.msh"))
    ordered = along_x(mesh)
    assert (np.diff(np.round(ordered.points[:, 0], 9)) >= 0.0).all()
    for name in mesh.surfaces:
        both = [
            facets.gauss(found.points[found.surfaces[name]], 2)[1].sum()
            for found in (mesh, ordered)
        ]
        assert both[0] == pytest.approx(both[1], rel=1e-12)
    assert len(boundary_facets(ordered.cells)) == len(boundary_facets(mesh.cells))


def rail():
    """A block as a file would hold it, so that a test can spoil it."""
    mesh = tets.split(block((4, 2, 2), (0.04, 0.02, 0.02)))
    outside = boundary_facets(mesh.cells)
    top = outside[(mesh.points[outside][:, :, 2] > 0.02 - 1e-9).all(axis=1)]
    return msh.tagged(mesh.points, mesh.cells, {"contact_z": top, "mount": mesh.surfaces["mount"]})


def test_faces_of_every_element_close_and_look_outwards():
    mesh = read(rail())
    vectors = tets.face_vectors(mesh.points, mesh.cells)
    corners = mesh.points[mesh.cells[:, cells.TETRAHEDRON.faces[:, :3]]]
    out = corners.mean(axis=2) - mesh.points[mesh.cells[:, :4]].mean(axis=1)[:, None]
    assert np.abs(vectors.sum(axis=1)).max() < 1e-18 and ((vectors * out).sum(axis=2) > 0.0).all()
    assert mesh.warnings == ()


def test_inverted_elements_and_missing_surfaces_are_all_named():
    mesh = rail()
    mesh.cells[0].data[[4, 41]] = mesh.cells[0].data[[4, 41]][:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    mesh.field_data["clamp"] = mesh.field_data.pop("mount")
    with pytest.raises(MeshError) as caught:
        read(mesh)
    assert "inverted or flat elements: 5, 42" in str(caught.value)
    assert "no triangle group named 'mount'" in str(caught.value)


@pytest.mark.parametrize("share, sound", [(0.4, True), (0.8, False)])
def test_a_face_that_bulges_through_its_element_is_refused(share, sound):
    """The middles of the edges of one face drawn a share of the way to the centre of the solid: at
    0.8 a plane inside is flat. Control: at all four corners the Jacobian is positive in both
    cases."""
    points, element = tets.quadratic(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 1, 2, 3]])
    )
    points[4:7] += share * (np.full(3, 0.25) - points[4:7])
    inside = np.full(3, 0.125)
    _, gradients = tetrahedron.shape_functions(np.column_stack([np.zeros(3), np.eye(3), inside]))
    *corners, middle = np.linalg.det(tetrahedron.jacobians(points[element], gradients))[0]
    assert min(corners) > 0.01 and (middle > 0.01) == sound
    assert (cells.jacobians(points, element)[0].min() > 0.0) == sound


@pytest.mark.case("X14")
def test_a_sliver_is_named_with_its_altitude_and_the_step_it_forces():
    mesh = rail()
    inner = np.flatnonzero((np.abs(mesh.points - [0.02, 0.01, 0.01]) < 1e-9).all(axis=1))[0]
    mesh.points[inner, 0] = 0.03 - 1e-5
    data = mesh.cells[0].data
    edges = data[:, cells.TETRAHEDRON.edges]
    mesh.points[data[:, 4:].ravel()] = mesh.points[edges].mean(axis=2).reshape(-1, 3)
    sliver, step = with_sliver_steps(read(mesh), SimpleNamespace(**ALUMINIUM)).warnings
    thin = ", ".join(map(str, np.flatnonzero(cells.thickness(mesh.points, data) < 2e-5) + 1))
    assert (
        thin
        and f"slivers: elements {thin};" in sliver
        and "shortest altitude" in sliver
        and "times the steps" in sliver
    )
    forced, other = (
        float(words.split(" s")[0]) for words in step.split("step of at most ")[1].split("one of ")
    )
    assert f"slivers {thin} force" in step and forced < 0.01 * other


@pytest.mark.parametrize(
    "kinds, words",
    [
        (("tetra10", "hexahedron"), "both 8-node hexahedra and 10-node tetrahedra"),
        (
            ("tetra10", "wedge"),
            "solid elements of other types: wedge; hexahedra of 8, 20 or 27 nodes and tetrahedra",
        ),
    ],
)
def test_other_elements_are_refused(kinds, words):
    sizes = {"tetra": 4, "tetra10": 10, "hexahedron": 8, "wedge": 6}
    points = np.concatenate([rail().points[rail().cells[0].data[0]], np.eye(8, 3)])
    with pytest.raises(MeshError, match=words):
        read(meshio.Mesh(points, [(kind, [list(range(sizes[kind]))]) for kind in kinds]))


def test_surface_elements_of_any_order_name_faces():
    mesh = rail()
    blocks = [
        (block.type, block.data) if block.type == "tetra10" else ("triangle", block.data[:, :3])
        for block in mesh.cells
    ]
    corners = read(
        meshio.Mesh(mesh.points, blocks, field_data=mesh.field_data, cell_data=mesh.cell_data)
    )
    for name, found in read(mesh).surfaces.items():
        np.testing.assert_array_equal(corners.surfaces[name], found)
