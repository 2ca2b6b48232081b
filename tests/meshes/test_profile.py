"""Meshes of extruded sections: area and second moments against the outline, surfaces by sides, layers,
and mirror images."""

import numpy as np
import pytest

from tests.formats.test_outline import shape, table
from tests.scenes.section_shapes import SHAPES, T_SLOT
from tipoff.highfi.extruded import mesh as extruded
from tipoff.highfi.mesh import facets
from tipoff.highfi.mesh.cells import jacobians
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.statics import assembly
from tipoff.meshes import profile, quadrilaterals

pytestmark = pytest.mark.gmsh

LENGTH = 0.12
SPANS = ((0.0, 0.02), (0.08, 0.1))
MATERIAL = (2700.0, 70e9, 0.33)


def of(outline, **changes):
    """A rail of an outline whose first side is a wall, and whose third side is held."""
    found = profile.Profile(
        loops=outline.loops,
        blocks=(),
        area=outline.moments().area,
        walls=(0,),
        mounted=(2,),
        ends=(0.1, 0.1 + LENGTH),
        spans=SPANS,
        stretch=1.0,
        images=((1, 1),),
    )
    return found._replace(**changes)


def section_moments(points, quads):
    """Area and integrals of y^2 and z^2 over the quadrilaterals, each of two triangles."""
    total = np.zeros(3)
    for corners in ([0, 1, 2], [0, 2, 3]):
        at = points[quads[:, corners]]
        along, across = at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]
        area = 0.5 * (along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0])
        assert (area > 0.0).all()
        squares = (at**2).sum(axis=1) + at.sum(axis=1) ** 2
        total += [area.sum(), *(area[:, None] * squares / 12.0).sum(axis=0)]
    return total


@pytest.mark.parametrize("size", [0.003, 0.0015])
@pytest.mark.parametrize("name", SHAPES)
def test_the_mesh_has_the_area_and_second_moments_of_the_outline(name, size):
    outline = shape(**SHAPES[name])
    points, quads = quadrilaterals.of_outline(outline.loops, size)
    exact = outline.moments()
    about_origin = (
        exact.area,
        exact.yy + exact.area * exact.y**2,
        exact.zz + exact.area * exact.z**2,
    )
    assert section_moments(points, quads) == pytest.approx(about_origin, rel=1e-10)


def test_a_wall_thinner_than_two_elements_keeps_good_shapes():
    """Fronts of right angles. Control: halves of the quadrilaterals that solids from CAD get have
    corners of less than half a right angle."""
    built = profile.build(of(shape(**SHAPES["t_slot"])), 0.002)
    _, scaled = jacobians(built.points, built.cells[0].data)
    assert scaled.min() > 0.6 and scaled.min(axis=1).mean() > 0.9


@pytest.mark.parametrize("size", [0.006, 0.002])
@pytest.mark.parametrize(
    "section, fewest",
    [(T_SLOT | {"web": 0.002}, 52), (T_SLOT, 52), (SHAPES["rod"], 32)],
)
def test_the_blocks_of_a_section_fill_it_and_meet_node_to_node(size, section, fewest):
    """Area and second moments are those of the outline, and the free edges have its length. The mesh of a T-slot
    has one element through a lip; gmsh makes more than twice as many."""
    rail = table(**section)
    outline, exact = rail.outline(), rail.outline().moments()
    points, quads = quadrilaterals.of_outline(outline.loops, size, rail.blocks())
    expected = (exact.area, exact.yy, exact.zz)
    assert section_moments(points, quads) == pytest.approx(expected, rel=1e-10)
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    pairs, count = np.unique(edges, axis=0, return_counts=True)
    free = np.linalg.norm(np.diff(points[pairs[count == 1]], axis=1), axis=2).sum()
    whole = sum(np.hypot(*np.subtract(side.end, side.start)) for side in outline.sides())
    assert count.max() == 2 and free == pytest.approx(whole, rel=1e-10)
    built = profile.build(of(outline, blocks=rail.blocks()), size)
    _, scaled = jacobians(built.points, built.cells[0].data)
    assert scaled.min() > 0.7 and scaled.min(axis=1).mean() > 0.88
    if size == 0.006:
        assert len(quads) == fewest
        if fewest == 52:
            assert len(quadrilaterals.of_outline(outline.loops, size)[1]) > 2 * 52


@pytest.mark.parametrize("name", ["t_slot", "box"])
def test_surfaces_are_the_sides_of_the_section(name):
    """The wall has the area of its side along the whole rail, and faces away from the metal; the mount
    has that of its spans."""
    outline = shape(**SHAPES[name])
    mesh = read(profile.build(of(outline), 0.003))
    for surface, number, length in (("contact_0", 0, LENGTH), ("mount", 2, 0.04)):
        side = outline.sides()[number]
        width = np.hypot(*np.subtract(side.end, side.start))
        found = mesh.surfaces[surface]
        assert facets.area(mesh.points, found) == pytest.approx(width * length, rel=1e-9)
        normals = facets.normals(mesh.points[found])
        assert normals[:, 1:] == pytest.approx(np.tile(side.normal, (len(found), 1)), abs=1e-9)


def test_mirror_images_are_solids_too_with_walls_that_face_away_from_them():
    outline = shape(**SHAPES["tee"])
    images = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    one, four = (
        read(profile.build(of(outline.at((0.1, 0.2)), images=each), 0.004))
        for each in (images[:1], images)
    )
    assert len(four.cells) == 4 * len(one.cells)
    assert np.abs(four.points[:, 1]).min() > 0.08 and four.points[:, 1].min() < -0.08
    area, whole = (facets.area(mesh.points, mesh.surfaces["contact_0"]) for mesh in (one, four))
    assert whole == pytest.approx(4.0 * area)


def test_layers_are_even_and_stretched():
    """Layers of one length that divides all spans, so that the kernel of extruded meshes takes them."""
    rail = of(shape(**SHAPES["t_slot"]), stretch=2.5)
    mesh = read(profile.build(rail, 0.004))
    assert np.unique(np.round(np.diff(np.unique(np.round(mesh.points[:, 0], 9))), 9)) == [0.01]
    assert extruded.find(mesh.points, assembly.build(mesh, *MATERIAL)) is not None


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("size", [0.003, 0.001])
def test_the_number_of_elements_is_known_about_before_they_are_made(name, size):
    rail = of(shape(**SHAPES[name]))
    made = len(profile.build(rail, size).cells[0].data)
    assert 0.4 < profile.elements(rail, size) / made < 3.0
