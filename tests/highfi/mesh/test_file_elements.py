"""Elements of files that the solver does not have: what they become has the shape that the file gives."""

import meshio
import numpy as np
import pytest

from tests.formats.meshes import seeds
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh import facets, file_elements
from tipoff.highfi.mesh.cells import HEXAHEDRON, TETRAHEDRON, edge_lengths
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.meshes import generator, msh

ELEMENTS = {"hexahedron20": (2, 1), "hexahedron27": (2, 0), "tetra": (1, 0), "tetra10": (2, 0)}


def plate(gmsh, kind: str) -> None:
    """The plate of ``seeds`` in elements of a type, with its surfaces as physical groups."""
    occ, mesh = gmsh.model.occ, gmsh.model.mesh
    occ.addBox(0.0, 0.0, 0.0, seeds.LENGTH, seeds.WIDTH, seeds.HEIGHT)
    occ.synchronize()
    middles = {tag: occ.getCenterOfMass(2, tag) for _, tag in gmsh.model.getEntities(2)}
    for number, (name, axis) in enumerate((("mount", 2), ("contact", 0)), 1):
        tags = [tag for tag, middle in middles.items() if middle[axis] < 1e-9]
        gmsh.model.addPhysicalGroup(2, tags, number, name=name)
    gmsh.model.addPhysicalGroup(3, [1], 3, name="rail")
    for _, edge in gmsh.model.getEntities(1):
        mesh.setTransfiniteCurve(edge, 3)
    if kind.startswith("hexahedron"):
        mesh.setTransfiniteAutomatic()
    order, incomplete = ELEMENTS.get(kind, (1, 0))
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
    mesh.generate(3)
    mesh.setOrder(order)


@pytest.mark.gmsh
@pytest.mark.parametrize("kind", ELEMENTS)
def test_elements_of_gmsh_become_those_of_the_solver(tmp_path, kind):
    """Volume and areas are exact; every node of the file is used. Control: corners alone would be 64
    nodes of 27 bricks."""
    with generator.session("plate") as gmsh:
        plate(gmsh, kind)
        nodes = len(gmsh.model.mesh.getNodes()[0])
        gmsh.write(str(tmp_path / "plate.msh"))
    mesh = read(tmp_path / "plate.msh")
    areas = {name: facets.area(mesh.points, found) for name, found in mesh.surfaces.items()}
    assert areas == pytest.approx(seeds.AREAS, rel=1e-12)
    if kind.startswith("hexahedron"):
        assert (len(mesh.cells), len(mesh.points)) == (216, 343)
        volume = hexahedron.basis(mesh.points[mesh.cells]).dx.sum()
        assert volume == pytest.approx(seeds.VOLUME, rel=1e-12)
        assert "split into 8 of 8 nodes" in mesh.warnings[0]
        assert nodes == {"hexahedron20": 208, "hexahedron27": 343}[kind]
    else:
        assert mesh.cells.shape[1] == 10 and not mesh.warnings
        corners = mesh.points[mesh.cells[:, :4]]
        volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
        assert volumes.sum() == pytest.approx(seeds.VOLUME, rel=1e-12)
        ends = corners[:, TETRAHEDRON.edges]
        np.testing.assert_allclose(mesh.points[mesh.cells[:, 4:]], ends.mean(axis=2), atol=1e-15)


def bent(places: np.ndarray) -> np.ndarray:
    """A map whose components have no higher power than two, so that 27 nodes give it exactly."""
    x, y, z = places.T
    return np.stack([x + 0.1 * y * y, y - 0.05 * x * z, z + 0.07 * x * x - 0.04 * x * y], axis=1)


@pytest.mark.parametrize("kind, worst", [("hexahedron20", 1e-15), ("hexahedron27", 1e-15)])
def test_new_nodes_lie_on_the_curved_element(kind, worst):
    """Maps up to second order in all are within both elements, so the centre of each part is where the
    map puts it. Control: straight edges are not."""
    corners = HEXAHEDRON_CORNERS
    middles = corners[HEXAHEDRON.edges].mean(axis=1)
    faces = corners[HEXAHEDRON.faces].mean(axis=1)
    every = [corners, middles] + [faces, np.zeros((1, 3))] * (kind == "hexahedron27")
    points = bent(np.concatenate(every))
    rng = np.random.default_rng(1)  # formats number middles in different orders
    order = np.r_[:8, 8 + rng.permutation(12), 20 + rng.permutation(len(points) - 20)]
    made, cells, astray = file_elements.converted(kind, points, order[None])
    assert not len(astray)
    expected = 0.5 * (corners[:, None] + corners[None])
    np.testing.assert_allclose(
        made[cells], bent(expected.reshape(-1, 3)).reshape(8, 8, 3), atol=worst
    )
    straight = 0.5 * (points[:8][:, None] + points[:8][None])
    assert np.abs(made[cells] - straight).max() > 0.02


HEXAHEDRON_CORNERS = np.array(
    [[x, y, z] for z in (-1.0, 1.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
)


def solid(kind: str, scale: float = 1.0) -> meshio.Mesh:
    """One element with its lower face as mount and the face at x = -1 as contact, given by nodes of
    eight in a quadratic quadrilateral and by a set of points."""
    corners = HEXAHEDRON_CORNERS
    points = np.concatenate([corners, corners[HEXAHEDRON.edges].mean(axis=1)])
    lower = [[0, 3, 2, 1, 11, 10, 9, 8]]
    return meshio.Mesh(
        scale * points,
        [(kind, [list(range(20))]), ("quad8", lower)],
        cell_sets={"mount": [np.array([], dtype=int), np.array([0])]},
        point_sets={"contact": np.flatnonzero(points[:, 0] == -1.0), "other": [0]},
    )


def test_groups_of_nodes_name_the_faces_between_them():
    mesh = read(solid("hexahedron20"))
    areas = {name: facets.area(mesh.points, found) for name, found in mesh.surfaces.items()}
    assert areas == pytest.approx({"mount": 4.0, "contact": 4.0})
    assert np.ptp(edge_lengths(mesh.points, mesh.cells)) == 0.0


def test_middle_nodes_elsewhere_are_a_fault():
    mesh = solid("hexahedron20")
    mesh.points[8] = mesh.points[9]
    with pytest.raises(MeshError, match="middle nodes far from the middles of edges: elements 1"):
        read(mesh)


@pytest.mark.parametrize(
    "scale, why", [(1e-200, "inverted or flat elements: 1"), (1e200, "too large")]
)
def test_elements_whose_volume_no_number_holds_are_a_fault(scale, why):
    """Control: bricks a millionth as long as usual have one."""
    points, *rest = seeds.rail()
    with pytest.raises(MeshError, match=why):
        read(msh.tagged(scale * points, *rest))
    assert len(read(msh.tagged(1e-6 * points, *rest)).cells) == seeds.ELEMENTS


def test_names_of_surfaces_do_not_depend_on_case():
    mesh = solid("hexahedron20")
    mesh.cell_sets = {"MOUNT": mesh.cell_sets["mount"]}
    mesh.point_sets = {"Contact_A": mesh.point_sets["contact"]}
    assert set(read(mesh).surfaces) == {"mount", "contact_a"}
