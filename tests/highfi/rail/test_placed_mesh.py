"""Mesh files in another unit, in other axes, with another origin, with other bodies beside the rail, and
with walls named by boxes or by groups of other names: they give the rail of the scene."""

import json
import re

import meshio
import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tests.highfi.rail.test_own_rail import channels, from_file, saved
from tipoff import highfi
from tipoff.highfi.mesh import facets
from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.meshes import channel
from tipoff.scenes import SceneError
from tipoff.scenes.rail import determinant, directions

SIZE = 0.004


@pytest.fixture(scope="module")
def own():
    """The channel in scene axes and metres."""
    return make_mesh(channels(), SIZE)


def drawn(tmp_path, change, **keys):
    """A scene whose file has its points changed by a function, with further keys of the rail."""
    mesh = channel.build()
    mesh.points = change(mesh.points)
    scene = from_file(channels(), saved(mesh, tmp_path / "rails.msh"))
    return scene.replace({"rail": scene.rail.model_dump() | keys})


def check_same(found, expected):
    """Nodes to rounding, and the same surfaces."""
    np.testing.assert_allclose(found.points, expected.points, atol=1e-12)
    np.testing.assert_array_equal(found.cells, expected.cells)
    for name, group in expected.surfaces.items():
        assert np.array_equal(_sorted(found.surfaces[name]), _sorted(group)), name


def _sorted(group):
    return np.unique(np.sort(group, axis=1), axis=0)


@pytest.mark.parametrize(
    "unit, scale",
    [("mm", 1e3), ("cm", 1e2), ("in", 1.0 / 0.0254), ("ft", 1.0 / 0.3048), ("m", 1.0)],
)
def test_a_file_in_another_unit(tmp_path, own, unit, scale):
    check_same(make_mesh(drawn(tmp_path, lambda points: scale * points, unit=unit), SIZE), own)


def test_a_file_in_other_axes_with_another_origin(tmp_path, own):
    """The rail along -y of the file, whose origin is elsewhere. Control: without the origin the walls
    are elsewhere."""
    axes, origin = ("-y", "z", "-x"), (0.3, -0.2, 0.05)
    turn = np.array(directions(axes))
    assert np.linalg.det(turn) == pytest.approx(1.0)
    keys = dict(unit="mm", axes=axes, origin=origin)
    scene = drawn(tmp_path, lambda points: 1e3 * (points @ turn + origin), **keys)
    check_same(make_mesh(scene, SIZE), own)
    assert highfi.prepare(scene, highfi.Numerics(element_size=SIZE)).cells.size
    elsewhere = scene.replace({"rail": scene.rail.model_dump() | {"origin": (0.3, -0.2, 0.0)}})
    with pytest.raises(SceneError, match="no wall under its track"):
        highfi.prepare(elsewhere)


@pytest.mark.parametrize("axes", [("x", "z", "y"), ("x", "y", "-z"), ("x", "x", "z")])
def test_axes_that_mirror_the_rail_are_refused(tmp_path, axes):
    assert determinant(axes) != 1.0
    with pytest.raises(SceneError, match=r"rail.axes.*right-handed"):
        drawn(tmp_path, lambda points: points, axes=axes)


@pytest.mark.parametrize(
    "change, keys, words",
    [
        (
            lambda points: 1e3 * points,
            {},
            'in millimetres, not in metres: if so, set rail.unit = "mm"',
        ),
        (
            lambda points: points,
            {"unit": "mm"},
            'in metres, not in millimetres: .* rail.unit = "m"',
        ),
        (lambda points: points[:, [2, 0, 1]], {}, r'rail.axes .* such as \["y", "z", "x"\]'),
        (lambda points: points[:, [1, 2, 0]], {}, r'rail.axes .* such as \["z", "x", "y"\]'),
        (
            lambda points: points[:, [1, 2, 0]],
            {"axes": ("y", "z", "x")},
            r'rail.axes .* such as \["z", "x", "y"\]',
        ),
    ],
)
def test_a_wrong_unit_or_axis_is_named_with_its_remedy(tmp_path, own, change, keys, words):
    """The proposed value is right."""
    scene = drawn(tmp_path, change, **keys)
    with pytest.raises(SceneError, match=words) as caught:
        make_mesh(scene, SIZE)
    text = str(caught.value)
    if found := re.search(r'rail.unit = "(\w+)"', text):
        remedy = {"unit": found[1]}
    else:
        remedy = {"axes": json.loads(text.split("such as ")[1].split("]")[0] + "]")}
    check_same(make_mesh(scene.replace({"rail": scene.rail.model_dump() | remedy}), SIZE), own)


def without_groups(path):
    """The channel as a file whose facets are in no group."""
    mesh = channel.build()
    solids = [block for block in mesh.cells if block.type == "hexahedron"]
    meshio.Mesh(mesh.points, solids).write(path)
    return path


def flat_boxes(mesh):
    """A box around each connected piece of each surface (name -> boxes)."""
    boxes = {}
    for name, group in mesh.surfaces.items():
        ends = np.repeat(group[:, 0], 4), group.ravel()
        graph = coo_array((np.ones(ends[0].size), ends), shape=(len(mesh.points),) * 2)
        piece = connected_components(graph, directed=False)[1][group[:, 0]]
        for one in np.unique(piece):
            corners = mesh.points[group[piece == one]].reshape(-1, 3)
            boxes.setdefault(name, []).append(
                (corners.min(axis=0).tolist(), corners.max(axis=0).tolist())
            )
    return boxes


def test_walls_and_mounts_named_by_boxes(tmp_path, own):
    """In a file of Abaqus without any group. Control: a file without groups and boxes is refused."""
    path = without_groups(tmp_path / "rails.inp")
    scene = from_file(channels(), path)
    with pytest.raises(MeshError, match="no quadrilateral group named 'mount'"):
        make_mesh(scene, SIZE)
    found = make_mesh(with_boxes(scene, flat_boxes(own)), SIZE)
    check_same(found, own)


def with_boxes(scene, boxes, **keys):
    tables = {
        name: [{"low": low, "high": high} for low, high in given] for name, given in boxes.items()
    }
    return scene.replace({"rail": scene.rail.model_dump() | {"surfaces": tables} | keys})


def plate(tmp_path, name="plate.inp"):
    """A scene of the channel whose file is a plate of 40 x 20 x 8 mm in 4 x 2 x 1 bricks."""
    from tests.formats.meshes import seeds

    points, cells, _ = seeds.rail()
    meshio.Mesh(points, [("hexahedron", cells)]).write(tmp_path / name)
    return from_file(channels(), tmp_path / name)


LOWER = ([0.0, 0.0, 0.0], [0.04, 0.02, 0.0])
END = ([0.0, 0.0, 0.0], [0.0, 0.02, 0.008])


@pytest.mark.parametrize(
    "mount, why",
    [
        (
            ([0.0, 0.0, 0.0], [0.025, 0.02, 0.0]),
            "box 1 cuts 2 faces of elements, the first with x 0.02",
        ),
        (([0.0, 0.0, 0.0], [0.04, 0.019, 0.0]), "box 1 cuts 4 faces"),
        (([0.0, 0.0, 0.5], [0.04, 0.02, 0.6]), r"box 1 contains no face .* z 0 to 0.008 m"),
        (([0.0, 0.0, 0.0], [0.005, 0.02, 0.0]), "box 1 contains no face of an element"),
    ],
)
def test_a_box_that_cuts_elements_or_holds_none_is_refused(tmp_path, mount, why):
    scene = with_boxes(plate(tmp_path), {"mount": [mount], "contact": [END]})
    with pytest.raises(MeshError, match=f"surface 'mount': {why}"):
        make_mesh(scene, SIZE)


def test_a_box_takes_what_lies_in_it(tmp_path):
    """Flat boxes, two boxes of one surface, and a thick box, which takes end faces too."""
    from tipoff.highfi.mesh.asked import asked
    from tipoff.highfi.mesh.rail_mesh import read

    def areas(mount):
        scene = with_boxes(plate(tmp_path), {"mount": mount, "contact": [END]})
        mesh = read(scene.rail.path(), asked(scene.rail))
        return {name: facets.area(mesh.points, group) for name, group in mesh.surfaces.items()}

    whole, end = 0.04 * 0.02, 0.02 * 0.008
    assert areas([LOWER]) == pytest.approx({"mount": whole, "contact": end})
    halves = [([0.0, 0.0, 0.0], [0.02, 0.02, 0.0]), ([0.02, 0.0, 0.0], [0.04, 0.02, 0.0])]
    assert areas(halves) == pytest.approx({"mount": whole, "contact": end})
    assert areas(halves[:1])["mount"] == pytest.approx(0.5 * whole)
    thick = ([-1.0, -1.0, -1.0], [0.02, 1.0, 1.0])
    half_around = 2 * 0.5 * whole + end + 2 * 0.02 * 0.008
    assert areas([thick])["mount"] == pytest.approx(half_around)


def test_groups_of_other_names_are_walls_and_mounts(tmp_path, own):
    """Names in any case, and two groups for one wall. A name that the file lacks is refused."""
    mesh = channel.build()
    names = {name: f"Face of {name}" for name in own.surfaces}
    mesh.field_data = {names.get(name, name): tag for name, tag in mesh.field_data.items()}
    scene = from_file(channels(), saved(mesh, tmp_path / "rails.msh"))
    groups = {name: [other.upper()] for name, other in names.items()}
    check_same(
        make_mesh(scene.replace({"rail": scene.rail.model_dump() | {"groups": groups}}), SIZE), own
    )
    groups["mount"] = [names["mount"], names["mount"].lower()]  # a face of two groups counts once
    check_same(
        make_mesh(scene.replace({"rail": scene.rail.model_dump() | {"groups": groups}}), SIZE), own
    )
    groups["mount"] = ["bolts"]
    with pytest.raises(MeshError, match="no group 'bolts' .groups in the mesh: Face of contact"):
        make_mesh(scene.replace({"rail": scene.rail.model_dump() | {"groups": groups}}), SIZE)
    with pytest.raises(SceneError, match="rail.groups.*starts with 'contact' or is 'mount'"):
        scene.replace({"rail": scene.rail.model_dump() | {"groups": {"wall": ["bolts"]}}})


def test_a_body_beside_others_is_picked_by_its_name(tmp_path, own):
    """The channel and a payload of tetrahedra, which alone would be refused."""
    mesh = channel.build()
    volume, _ = mesh.field_data["rail"]
    corners = np.array([[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]) + 0.01
    blocks = [*mesh.cells, ("wedge", np.array([[0, 1, 2, 3, 3, 3]]) + len(mesh.points))]
    both = meshio.Mesh(
        np.concatenate([mesh.points, corners]),
        blocks,
        field_data=mesh.field_data | {"payload": np.array([volume + 1, 3])},
        cell_data={
            key: [*parts, np.array([volume + 1], dtype=np.int32)]
            for key, parts in mesh.cell_data.items()
        },
    )
    scene = from_file(channels(), saved(both, tmp_path / "all.msh"))
    with pytest.raises(MeshError, match="solid elements of other types: wedge"):
        make_mesh(scene, SIZE)

    def of(body):
        return make_mesh(scene.replace({"rail": scene.rail.model_dump() | {"body": body}}), SIZE)

    check_same(of("rail"), own)
    check_same(of("RAIL"), own)
    with pytest.raises(MeshError, match="no body 'rails' .groups of solids: payload, rail"):
        of("rails")
