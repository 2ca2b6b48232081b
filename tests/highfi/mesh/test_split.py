"""Elements split evenly: the mesh that would have been made at the smaller size, whatever the
corners' numbering."""

import numpy as np
import pytest

from tests.highfi import tets
from tests.highfi.blocks import block
from tests.highfi.mesh.test_rail_mesh import AREAS, facet_vectors
from tipoff.highfi.elements import tetrahedron
from tipoff.highfi.mesh.cells import corner_jacobians, jacobians
from tipoff.highfi.mesh.facets import gauss
from tipoff.highfi.mesh.halve import halved
from tipoff.highfi.mesh.rail_mesh import boundary_facets, read
from tipoff.highfi.mesh.split import refined, split, to_size
from tipoff.meshes import channel, l_rail


def ordered(points) -> np.ndarray:
    """Points as a set, rounded to a nanometre."""
    return np.unique(np.round(points, 9), axis=0)


@pytest.fixture(scope="module")
def rails():
    return read(l_rail.build(l_rail.LRailGeometry(), 0.008))


def test_a_split_mesh_is_the_one_made_at_half_the_size():
    coarse, fine = (read(l_rail.build(l_rail.LRailGeometry(), size)) for size in (0.004, 0.002))
    found = split(coarse, 2)
    assert len(found.points) == len(fine.points) and len(found.cells) == len(fine.cells)
    assert np.array_equal(ordered(found.points), ordered(fine.points))
    for name in AREAS:
        assert np.array_equal(
            ordered(facet_vectors(found, name)[1]), ordered(facet_vectors(fine, name)[1])
        )


@pytest.mark.parametrize("parts", [2, 3])
def test_volume_area_and_neighbours_stay(rails, parts):
    mesh = read(channel.build())
    found = split(mesh, parts)
    volume = corner_jacobians(mesh.points, mesh.cells)[0].mean(axis=1).sum()
    assert corner_jacobians(found.points, found.cells)[0].min() > 0.0
    assert corner_jacobians(found.points, found.cells)[0].mean(axis=1).sum() == pytest.approx(
        volume, rel=1e-12
    )
    # Neighbours that were not joined would show as faces inside the solid.
    assert len(boundary_facets(found.cells)) == parts**2 * len(boundary_facets(mesh.cells))
    outside = {tuple(sorted(facet)) for facet in boundary_facets(found.cells).tolist()}
    for name in mesh.surfaces:
        assert {tuple(sorted(facet)) for facet in found.surfaces[name].tolist()} <= outside
        assert facet_vectors(found, name)[0].sum(axis=0) == pytest.approx(
            facet_vectors(mesh, name)[0].sum(axis=0), abs=1e-15
        )


def test_numbering_of_corners_does_not_matter(rails):
    """Every element turned a quarter about one of its axes: neighbours then see their common face
    from other corners."""
    turned = rails.cells.copy()
    turned[::2] = turned[::2][:, [1, 2, 3, 0, 5, 6, 7, 4]]
    plain, other = split(rails, 2), split(type(rails)(rails.points, turned, rails.surfaces), 2)
    assert len(plain.points) == len(other.points)
    assert np.array_equal(ordered(plain.points), ordered(other.points))


@pytest.mark.parametrize("size, parts", [(0.008, 1), (0.004, 1), (0.002, 2), (0.0013, 3)])
def test_element_size_says_how_finely(rails, size, parts):
    """The L rails made at 8 mm have one element across their wall of 4 mm."""
    assert len(to_size(rails, size).cells) == len(rails.cells) * parts**3


@pytest.mark.parametrize("bend", [0.0, 3.0])
def test_halved_tetrahedra_keep_volume_areas_and_neighbours(bend):
    """Straight and, along a parabola, curved: the halves of a quadratic edge are the quadratic
    edges of its halves."""
    mesh = tets.split(block((3, 1, 2), (0.03, 0.01, 0.02)))
    mesh = tets.bent(mesh, lambda x: x + np.outer(bend * x[:, 0] ** 2, [0.0, 1.0, 0.5]))
    found = halved(mesh)
    assert (
        len(found.cells) == 8 * len(mesh.cells)
        and jacobians(found.points, found.cells)[0].min() > 0.0
    )
    before, after = (
        tetrahedron.kinematics(each.points[each.cells]).volume.sum() for each in (mesh, found)
    )
    assert after == pytest.approx(before, rel=1e-12)
    # Neighbours that were not joined would show as faces inside the solid.
    assert len(boundary_facets(found.cells)) == 4 * len(boundary_facets(mesh.cells))
    outside = {tuple(sorted(facet)) for facet in boundary_facets(found.cells).tolist()}
    assert {tuple(sorted(facet)) for facet in found.surfaces["mount"].tolist()} <= outside
    before, after = (
        gauss(each.points[each.surfaces["mount"]], 6)[1].sum() for each in (mesh, found)
    )
    assert after == pytest.approx(before, rel=1e-12)


def test_a_smaller_element_size_halves_tetrahedra_again_and_again():
    mesh = tets.split(block((2, 1, 1), (0.02, 0.01, 0.01)))
    assert [
        len(to_size(mesh, size).cells) // len(mesh.cells) for size in (0.02, 0.01, 0.005, 0.0026)
    ] == [1, 1, 8, 64]


def test_halves_become_no_flatter():
    mesh = tets.split(block((1, 1, 1), (0.01, 0.01, 0.01)))
    once, twice = halved(mesh), halved(halved(mesh))
    quality = [jacobians(each.points, each.cells)[1].min() for each in (mesh, once, twice)]
    assert quality[2] == pytest.approx(quality[1], rel=1e-9) and quality[1] > 0.5 * quality[0]


def test_finer_nodes_are_numbered_in_the_order_of_the_elements(rails):
    """Neighbours are near each other in memory. Control: names in any order give any numbers."""
    finer, _ = refined(rails)
    _, first = np.unique(finer.cells, return_index=True)
    coarse_element = first // (8 * finer.cells.shape[1])
    assert (np.diff(coarse_element) >= 0).all()
    shuffled = np.random.default_rng(0).permutation(len(finer.points))[finer.cells]
    assert (np.diff(np.unique(shuffled, return_index=True)[1] // 64) < 0).any()
