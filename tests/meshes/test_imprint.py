"""Boxes that end within a face of a solid: their borders become borders of elements, and the areas are
those of the drawing."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

from tests.meshes.test_solid import (
    END,
    INNER,
    OUTER,
    START,
    drawn,
    drilled,
    flat,
    l_sections,
    l_surfaces,
    mesh_here,
    scene_of,
    tilted_plate,
)
from tipoff.highfi import compliance
from tipoff.highfi.mesh import facets
from tipoff.highfi.mesh.rail_mesh import MeshError, boundary_facets
from tipoff.highfi.rail.fit import check_areas
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.highfi.statics.held import distinct
from tipoff.meshes import solid
from tipoff.scenes import load
from tipoff.scenes.scene_model import built

pytestmark = pytest.mark.gmsh
TOP = flat(2, 0.008, [(0, 0), (0.04, 0.02)])
# Two clamped patches below the block of 40 x 20 x 8 mm, one beside its hole, one cut by it.
BESIDE = flat(2, 0.0, [(0.0031, 0.0027), (0.0113, 0.0171)])
ACROSS = flat(2, 0.0, [(0.02, 0.0027), (0.04, 0.01)])


def block(path, mount, **rail):
    """The drilled block, its whole top a wall."""
    surfaces = {"contact_top": [TOP], "mount": mount}
    scene = scene_of(drawn(path / "block.step", drilled), surfaces, 0.0, 0.04)
    return scene.replace({f"rail.{key}": value for key, value in rail.items()})


def area_of(mesh, name):
    return facets.area(mesh.points, mesh.surfaces[name])


@pytest.fixture(scope="module")
def unbordered(tmp_path_factory):
    """The block on one box that holds all of the face below."""
    below = [flat(2, 0.0, [(0, 0), (0.04, 0.02)])]
    return mesh_here(block(tmp_path_factory.mktemp("whole"), below), 0.002)


@pytest.fixture(scope="module")
def bordered(tmp_path_factory):
    """Scene and mesh of the block on both boxes, by the kind of its elements."""

    @functools.cache
    def made(elements):
        scene = block(tmp_path_factory.mktemp(elements), [BESIDE, ACROSS], elements=elements)
        return scene, mesh_here(scene, 0.002)

    return made


@pytest.mark.parametrize("elements", ["hex8", "tet10"])
def test_a_box_that_cuts_through_a_face_keeps_all_of_its_area(bordered, unbordered, elements):
    """Control: facets that lie wholly in the boxes of a mesh without their borders cover less."""
    _, mesh = bordered(elements)
    area = 0.0082 * 0.0144 + 0.02 * 0.0073 - math.pi * 0.005**2 / 4.0
    assert mesh.drawn["mount"] == pytest.approx(area, rel=1e-6)
    assert area_of(mesh, "mount") == pytest.approx(area, rel=5e-3)
    loose = unbordered.points[boundary_facets(unbordered.cells)]
    below = loose[(loose[:, :, 2] < 1e-9).all(axis=1)]
    kept = [
        np.all(
            (below > np.array(box["low"]) - 1e-6) & (below < np.array(box["high"]) + 1e-6), (1, 2)
        )
        for box in (BESIDE, ACROSS)
    ]
    assert facets.gauss(below[np.any(kept, axis=0)], 2)[1].sum() < 0.8 * area


def test_a_box_that_cuts_the_side_of_an_extrusion_keeps_all_of_its_area(tmp_path):
    """A tilted plate of 100 x 20 x 4 mm, of which a box holds the 3 mm of the side and the 7 mm of
    the width nearest to one edge; the mesh stays one of layers."""
    turn = np.array([[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]])
    low, high = turn @ [-0.010, -0.002], turn @ [-0.010, 0.002]
    cut = (turn @ [-0.003, -0.002])[1]
    boxes = {
        "mount": np.array([[[0.021, -1.0, -1.0], [0.047, 1.0, cut]]]),
        "contact": np.array([[[-1.0, -1.0, -1.0], [2.0, 1.0, 1.0]]]),
    }
    points, hexes, areas = solid.build(drawn(tmp_path / "plate.step", tilted_plate), 0.004, boxes)
    on_side = min(0.004, 0.004 * (cut - low[1]) / (high[1] - low[1]))
    above = on_side if cut < high[1] else 0.004
    top = max(0.0, (cut - high[1]) / math.sin(0.5))
    exact = 0.026 * (0.007 + above + top)
    assert areas["mount"] == pytest.approx(exact, rel=1e-6)
    assert areas["contact"] == pytest.approx(2 * (0.1 * 0.024 + 0.02 * 0.004), rel=1e-6)
    sides = boundary_facets(hexes)
    nodes = points[sides]
    inside = (
        (nodes[:, :, 0] > 0.021 - 1e-6)
        & (nodes[:, :, 0] < 0.047 + 1e-6)
        & (nodes[:, :, 2] < cut + 1e-6)
    ).all(axis=1)
    assert facets.area(points, sides[inside]) == pytest.approx(exact, rel=1e-6)
    assert len(points) % len(np.unique(points[:, 0].round(9))) == 0


def test_every_box_on_no_face_is_named(tmp_path):
    """Others of the same surface lie on faces."""
    high = flat(2, 0.001, [(0.0, 0.0), (0.04, 0.02)])
    with pytest.raises(MeshError, match="lies in box 2 of mount, .0, 0, 0.001"):
        mesh_here(block(tmp_path, [BESIDE, high]), 0.004)


def test_a_surface_of_another_area_than_drawn_is_refused(bordered):
    scene, mesh = bordered("tet10")
    lost = mesh.surfaces | {"mount": mesh.surfaces["mount"][::2]}
    with pytest.raises(MeshError, match="'mount': .* mm2 of facets .* has 244.445 mm2"):
        check_areas(scene.rail, mesh.__class__(mesh.points, mesh.cells, lost, (), mesh.drawn))


def test_a_drawing_without_units_in_millimetres_is_named_before_it_is_meshed(tmp_path):
    """BREP files have no unit. The block would have 1e9 times as many elements."""
    surfaces = {"contact_top": [TOP], "mount": [BESIDE]}
    scene = scene_of(drawn(tmp_path / "block.brep", drilled), surfaces, 0.0, 0.04)
    with pytest.raises(MeshError, match="x 0 to 40, .* seems to be in millimetres"):
        mesh_here(scene, 0.002)


@pytest.mark.slow
def test_rails_in_tetrahedra_are_as_compliant_as_the_built_in_ones(tmp_path):
    """Their mounts end 4 mm from the outer corner, where the solid has no edge. Under a pad, between
    hexahedra of 4 and of 2 mm, which are 7 % apart. Control: with the facets that lie wholly in the
    boxes of a mesh without their borders, less than half of the mounts is left."""
    scene = load("reference").condition("phi0")
    rail = scene_of(drawn(tmp_path / "rails.step", l_sections), l_surfaces()).rail.model_dump()
    cad = scene.replace({"rail": rail | {"elements": "tet10"}})
    mesh = make_mesh(cad, 0.004)
    assert mesh.drawn["mount"] == pytest.approx(1.92e-3, rel=1e-9)
    assert area_of(mesh, "mount") == pytest.approx(1.92e-3, rel=1e-9)

    def under_a_pad(mesh):
        faces = built(scene).nominal
        origin = np.array(scene.platform.record().mass_centre)
        seen = faces._replace(wall=faces.wall + origin[faces.axis])
        reach = (scene.rail.start, scene.rail.end)
        found = compliance.of_rails(
            distinct(mesh, scene.rail.material), seen, reach, [0.03], patterns=1
        )
        return np.einsum("sff->sf", found.matrix[:, :, 0, :, 0])[0, 0]

    coarse, fine = (under_a_pad(make_mesh(scene, size)) for size in (0.004, 0.002))
    assert 0.98 * coarse < under_a_pad(mesh) < fine
    whole = {name: boxes for name, boxes in l_surfaces().items() if name != "mount"}
    whole["mount"] = [
        flat(axis, sign * OUTER, [(START, other * INNER - 0.02), (END, other * INNER + 0.02)])
        for axis in (1, 2)
        for sign in (1, -1)
        for other in (1, -1)
    ]
    plain = make_mesh(cad.replace({"rail.surfaces": whole}), 0.004)
    nodes = plain.points[plain.surfaces["mount"]]
    inside = [
        ((nodes > np.array(box["low"]) - 1e-6) & (nodes < np.array(box["high"]) + 1e-6)).all((1, 2))
        for box in l_surfaces()["mount"]
    ]
    kept = plain.surfaces["mount"][np.any(inside, axis=0)]
    lost = replace(plain, surfaces=plain.surfaces | {"mount": kept})
    assert area_of(lost, "mount") < 0.5 * 1.92e-3
