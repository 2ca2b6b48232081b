"""Rail meshes: what is built, what reading accepts, and that every fault of a file is named at
once."""

import copy
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from tests.highfi import gmsh_rails
from tipoff import scenes
from tipoff.highfi.mesh.cells import corner_jacobians, edge_lengths
from tipoff.highfi.mesh.rail_mesh import MeshError, along_x, read
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.meshes import generator, l_rail, msh

GEOMETRY = l_rail.LRailGeometry()
AREAS = {
    "contact_y": 4 * 0.220 * 0.020,
    "contact_z": 4 * 0.220 * 0.020,
    "mount": 4 * 2 * 3 * 0.020 * 0.004,
}
ROOT = Path(__file__).resolve().parents[3]
WITHOUT_GMSH = """
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name == "gmsh":
            raise OSError("libGL.so.1: cannot open shared object file: No such file or directory")

sys.meta_path.insert(0, Missing())
from tipoff import scenes
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.meshes import generator

print(len(make_mesh(scenes.load("tiny"), 0.008).cells), "gmsh" in sys.modules)
try:
    generator.load()
except generator.GmshUnavailable as reason:
    print(reason)
"""


@pytest.fixture(scope="module")
def built():
    return l_rail.build(GEOMETRY, 0.004)


def facet_vectors(mesh, name):
    """Area vectors (m,3) in m2, pointing out of the solid, and centres (m,3) in m."""
    corners = mesh.points[mesh.surfaces[name]]
    return 0.5 * np.cross(
        corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    ), corners.mean(axis=1)


def without(mesh, name):
    """The same file with one group missing."""
    tag = mesh.field_data[name][0]
    keep = [index for index, tags in enumerate(mesh.cell_data["gmsh:physical"]) if tags[0] != tag]
    return meshio.Mesh(
        mesh.points,
        [mesh.cells[index] for index in keep],
        field_data={key: value for key, value in mesh.field_data.items() if key != name},
        cell_data={
            key: [blocks[index] for index in keep] for key, blocks in mesh.cell_data.items()
        },
    )


@pytest.mark.parametrize(
    "size, count",
    [
        (0.004, 2420),
        (0.002, 19360),
        pytest.param(0.001, 154880, marks=pytest.mark.slow),
        (0.003, None),
    ],
)
def test_areas_and_volume_do_not_depend_on_the_mesh(size, count):
    mesh = read(l_rail.build(GEOMETRY, size))
    assert mesh.warnings == ()
    for name, area in AREAS.items():
        vectors, _ = facet_vectors(mesh, name)
        assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(area, rel=1e-12)
    jacobian, scaled = corner_jacobians(mesh.points, mesh.cells)
    assert jacobian.mean(axis=1).sum() == pytest.approx(4 * 176e-6 * 0.220, rel=1e-12)
    assert scaled.min() == pytest.approx(1.0, rel=1e-9)
    if count:
        assert len(mesh.cells) == count
        assert np.ptp(edge_lengths(mesh.points, mesh.cells)) < 1e-12


@pytest.mark.parametrize("size, even", [(0.0034, False), (0.0013, True), (0.0007, True)])
def test_layers_are_even_where_a_length_near_the_size_divides_all_intervals(size, even):
    """4 mm divide every interval between borders of the mounts; 1.33 and 0.667 mm are near enough
    to the size, but 4 mm is not to 3.4 mm."""
    stations = np.unique(np.round(l_rail.build(GEOMETRY, size).points[:, 0], 12))
    assert (np.ptp(np.diff(stations)) < 1e-9) == even


def test_walls_face_the_payload_and_mounts_face_away(built):
    mesh = read(built)
    for name, axis in (("contact_y", 1), ("contact_z", 2)):
        vectors, centres = facet_vectors(mesh, name)
        assert (vectors[:, axis] * centres[:, axis] < 0.0).all()
        assert np.abs(centres[:, axis]) == pytest.approx(0.10025, abs=1e-12)
        other = np.abs(centres[:, 3 - axis])
        assert other.min() == pytest.approx(0.10025 - 0.018) and other.max() == pytest.approx(
            0.10025 - 0.002
        )
    vectors, centres = facet_vectors(mesh, "mount")
    assert ((vectors * centres)[:, 1:].sum(axis=1) > 0.0).all()
    along = centres[:, 0] - GEOMETRY.x_start
    assert all(any(start < place < end for start, end in GEOMETRY.mount_spans) for place in along)


def test_rails_are_mirror_images_to_the_last_bit(built):
    quarter = len(built.points) // 4
    rails = built.points.reshape(4, quarter, 3)
    assert all(np.array_equal(np.abs(rail), np.abs(rails[0])) for rail in rails)


def test_build_is_repeatable_and_survives_a_file(built, tmp_path):
    msh.save(built, tmp_path / "first.msh")
    msh.save(l_rail.build(GEOMETRY, 0.004), tmp_path / "second.msh")
    assert (tmp_path / "first.msh").read_bytes() == (tmp_path / "second.msh").read_bytes()
    here, there = read(built), read(tmp_path / "first.msh")
    assert np.array_equal(here.points, there.points) and np.array_equal(here.cells, there.cells)
    assert all(np.array_equal(here.surfaces[name], there.surfaces[name]) for name in AREAS)


def by_place(points, *groups):
    """Points in the order of their places, and each group of node tuples (m,k) numbered so, in an
    order of its own."""
    order = np.lexsort(np.round(points, 9).T)
    number = np.argsort(order)
    return points[order], *(np.unique(np.sort(number[group], axis=1), axis=0) for group in groups)


@pytest.mark.gmsh
@pytest.mark.parametrize(
    "change, size",
    [
        ({}, 0.008),
        ({}, 0.004),
        ({}, 0.003),
        ({}, 0.002),
        ({}, 0.0034),
        ({"thickness": 0.003, "mount_width": 0.003}, 0.002),
        ({"mount_width": 0.002}, 0.002),
        ({"mount_width": 0.010}, 0.004),
        ({"x_start": -0.151903522, "x_end": 0.200577871}, 0.002),
    ],
)
def test_gmsh_makes_the_same_mesh(change, size):
    """Points, elements and surfaces are equal except for their numbers. gmsh places nodes of a
    transfinite side by integrating along it, to 5e-14 m."""
    geometry = GEOMETRY._replace(**change)
    theirs, hexes, surfaces = gmsh_rails.corner_rail(geometry, size)
    built = l_rail.build(geometry, size)
    rail = len(built.points) // 4
    blocks = [block.data for block in built.cells]
    ours = by_place(built.points[:rail], *(block[: len(block) // 4] for block in blocks))
    theirs = by_place(theirs, hexes, *(surfaces[name] for name in l_rail.SURFACES))
    assert ours[0].shape == theirs[0].shape and np.abs(ours[0] - theirs[0]).max() < 1e-12
    for mine, other in zip(ours[1:], theirs[1:]):
        assert np.array_equal(mine, other)
    # Control: the L with legs two elements longer is another mesh.
    assert len(
        gmsh_rails.corner_rail(geometry._replace(leg=geometry.leg + 2.0 * size), size)[1]
    ) > len(hexes)


def test_built_in_rails_load_no_gmsh():
    """A fresh interpreter in which `import gmsh` fails as it does where a graphics library is
    missing."""
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_GMSH],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    made, reason = run.stdout.splitlines()  # the reason is one line
    assert made == f"{len(make_mesh(scenes.load('tiny'), 0.008).cells)} False"
    assert "libGL.so.1" in reason and generator.SYSTEM_INSTALL in reason


@pytest.mark.parametrize(
    "change",
    [{"thickness": 0.024}, {"mount_spans": ((0.02, 0.01),)}, {"mount_spans": ((0.2, 0.3),)}],
)
def test_impossible_geometry_is_refused(change):
    with pytest.raises(ValueError):
        l_rail.build(GEOMETRY._replace(**change), 0.004)


def test_named_sets_of_other_formats_are_read(built):
    sets = {
        name: [
            np.arange(len(block.data)) if index == place else np.array([], dtype=int)
            for index, block in enumerate(built.cells)
        ]
        for place, name in enumerate(l_rail.SURFACES, start=1)
    }
    mesh = read(meshio.Mesh(built.points, built.cells, cell_sets=sets))
    assert {name: len(facets) for name, facets in mesh.surfaces.items()} == {
        "contact_y": 1100,
        "contact_z": 1100,
        "mount": 120,
    }


def test_unused_points_are_dropped_and_numbering_follows(built):
    padded = meshio.Mesh(
        np.concatenate([[[9.0, 9.0, 9.0]], built.points]),
        [(block.type, block.data + 1) for block in built.cells],
        field_data=built.field_data,
        cell_data=built.cell_data,
    )
    here, there = read(built), read(padded)
    assert np.array_equal(here.points, there.points) and np.array_equal(here.cells, there.cells)
    ordered = along_x(there)
    assert (np.diff(np.round(ordered.points[:, 0], 9)) >= 0.0).all()
    for name in AREAS:
        assert np.allclose(
            facet_vectors(ordered, name)[0].sum(axis=0),
            facet_vectors(here, name)[0].sum(axis=0),
            atol=1e-15,
        )


def test_every_fault_is_reported_at_once(built):
    faulty = without(copy.deepcopy(built), "mount")
    hexes = faulty.cells[0].data
    hexes[[4, 41]] = hexes[[4, 41]][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    with pytest.raises(MeshError) as error:
        read(faulty)
    message = str(error.value)
    assert "inverted or flat elements: 5, 42" in message
    assert (
        "no quadrilateral group named 'mount' (groups in the mesh: contact_y, contact_z, rail)"
        in message
    )


def test_solids_without_hexahedra_and_inner_facets_are_faults(built):
    wedges = meshio.Mesh(np.eye(6, 3), [("wedge", [[0, 1, 2, 3, 4, 5]])])
    with pytest.raises(MeshError, match="(?s)wedge.*no solid elements.*contact.*mount"):
        read(wedges)
    inner = meshio.Mesh(
        built.points,
        [*built.cells, ("quad", built.cells[0].data[:1, [0, 2, 4, 6]])],
        field_data=built.field_data,
        cell_data={
            "gmsh:physical": [
                *built.cell_data["gmsh:physical"],
                built.cell_data["gmsh:physical"][1][:1],
            ]
        },
    )
    with pytest.raises(MeshError, match="'contact_y': 1 of 1101 facets are not on the boundary"):
        read(inner)


@pytest.mark.case("X14")
def test_slivers_and_skewed_elements_are_warned_about(built, tmp_path):
    points = built.points.copy()
    plane = np.isclose(points[:, 0], GEOMETRY.x_start + 0.004)
    points[plane, 0] = GEOMETRY.x_start + 5e-6
    (sliver,) = read(
        meshio.Mesh(points, built.cells, field_data=built.field_data, cell_data=built.cell_data)
    ).warnings
    thin = np.flatnonzero(edge_lengths(points, built.cells[0].data).min(axis=1) < 1e-5) + 1
    assert ", ".join(map(str, thin[:20])) in sliver and "5e-06 m" in sliver and "800" in sliver
    points = built.points.copy()
    points[:, 0] += points[:, 1]
    made = meshio.Mesh(points, built.cells, field_data=built.field_data, cell_data=built.cell_data)
    (skewed,) = read(made, made_here=True).warnings
    count = len(built.cells[0].data)
    assert f"skewed elements, {count:,} of {count:,}; " in skewed and "0.707" in skewed
    # numbers are of use in a file that the user has
    made.write(tmp_path / "rail.msh", file_format="gmsh22", binary=False)
    (skewed,) = read(tmp_path / "rail.msh").warnings
    assert "skewed elements: 1, 2, 3, " in skewed


@pytest.mark.gmsh
@pytest.mark.parametrize("version, binary", [(2.2, 0), (4.1, 0), (4.1, 1)])
@pytest.mark.parametrize("divisions", [1, 4])
def test_files_of_gmsh_are_read_in_its_own_formats(tmp_path, version, binary, divisions):
    """A brick of 20 x 10 x 5 mm meshed and named in gmsh itself, as a user would. Format 4.1 lists
    the entities that bound each face, whose numbers are larger than those of a few facets."""
    with generator.session("brick") as gmsh:
        gmsh.model.occ.addBox(0.0, 0.0, 0.0, 0.020, 0.010, 0.005)
        gmsh.model.occ.synchronize()
        for _, edge in gmsh.model.getEntities(1):
            gmsh.model.mesh.setTransfiniteCurve(edge, divisions + 1)
        gmsh.model.mesh.setTransfiniteAutomatic()
        sides = {
            tuple(np.round(gmsh.model.occ.getCenterOfMass(2, tag), 6)): tag
            for _, tag in gmsh.model.getEntities(2)
        }
        gmsh.model.addPhysicalGroup(2, [sides[0.01, 0.005, 0.005]], name="contact_top")
        gmsh.model.addPhysicalGroup(
            2, [sides[0.0, 0.005, 0.0025], sides[0.02, 0.005, 0.0025]], name="mount"
        )
        gmsh.model.addPhysicalGroup(3, [1], name="rail")
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(tmp_path / "brick.msh"))
    mesh = read(tmp_path / "brick.msh")
    assert set(mesh.surfaces) == {"contact_top", "mount"}
    assert facet_vectors(mesh, "contact_top")[0].sum(axis=0) == pytest.approx(
        [0.0, 0.0, 2e-4], abs=1e-15
    )
    assert np.abs(facet_vectors(mesh, "mount")[0]).sum(axis=0) == pytest.approx(
        [1e-4, 0.0, 0.0], abs=1e-15
    )
    assert corner_jacobians(mesh.points, mesh.cells)[0].mean(axis=1).sum() == pytest.approx(1e-6)


def test_a_file_of_abaqus_is_read(built, tmp_path):
    sets = {
        name: [
            np.arange(len(block.data)) if index == place else np.array([], dtype=int)
            for index, block in enumerate(built.cells)
        ]
        for place, name in enumerate(l_rail.SURFACES, start=1)
    }
    meshio.Mesh(built.points, built.cells, cell_sets=sets).write(tmp_path / "rails.inp")
    assert {
        name: len(facets) for name, facets in read(tmp_path / "rails.inp").surfaces.items()
    } == {"contact_y": 1100, "contact_z": 1100, "mount": 120}


def test_a_built_in_rail_that_nothing_holds_is_bad_input():
    with pytest.raises(scenes.SceneError, match="rail.mounts: given none, expected at least one"):
        make_mesh(scenes.load("tiny").replace({"rail.mounts": []}), 0.008)
