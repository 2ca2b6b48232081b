"""Contact on quadratic triangles: Gauss points, hulls, forces, and the stiffness that contact
adds."""

import numpy as np
import pytest

from tests.highfi import tets
from tests.highfi.blocks import block
from tests.highfi.contact.test_impact import GAP, WIDTH, scene
from tipoff.highfi.contact.surface import magnification
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_limit import contact_frequency_squared
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.mesh import facets
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.simulation import Loop

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0.5, 0]])
INTERFACE_STIFFNESS = 1e12


@pytest.mark.parametrize("quadrature", range(1, 13))
def test_points_of_a_triangle_are_as_dense_as_those_of_a_square(quadrature):
    shape, area = facets.gauss(TRIANGLE[None], quadrature)
    assert area.min() > 0.0 and area.sum() == pytest.approx(0.5, rel=1e-12)
    assert shape.sum(axis=1) == pytest.approx(1.0, rel=1e-12)
    assert 3 <= len(shape) and 0.5 * quadrature**2 <= len(shape) <= max(3, 0.85 * quadrature**2)
    # An even pressure loads the middles alone, a third each.
    assert area[0] @ shape == pytest.approx([0, 0, 0, 1 / 6, 1 / 6, 1 / 6], abs=1e-12)
    assert shape @ TRIANGLE == pytest.approx(np.clip(shape @ TRIANGLE, 0.0, 1.0))


def test_a_curved_facet_lies_in_its_hull_and_not_in_that_of_its_nodes():
    random, beyond = np.random.default_rng(0), 0.0
    shape, _ = facets.gauss(TRIANGLE[None], 12)
    for _ in range(50):
        nodes = TRIANGLE + 0.3 * random.standard_normal((6, 3))
        direction = random.standard_normal(3)
        lowest = (shape @ nodes @ direction).min()
        assert (facets.hull(nodes[None])[0] @ direction).min() <= lowest
        beyond = max(beyond, (nodes @ direction).min() - lowest)
    assert beyond > 0.01


@pytest.mark.parametrize("corners", [TRIANGLE[:, :2], np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])])
def test_weights_of_a_point_are_those_of_the_place_it_was_made_from(corners):
    """All nodes of the facets are moved out of place. A point beyond the hull of a facet is in
    none, though the iteration may stop at a place inside."""
    random = np.random.default_rng(1)
    shape, _ = facets.gauss(np.column_stack([corners, np.zeros(len(corners))])[None], 6)
    for _ in range(20):
        nodes = corners + 0.05 * random.standard_normal(corners.shape)
        found, inside = facets.weights(
            np.broadcast_to(nodes, (len(shape), *nodes.shape)), shape @ nodes
        )
        assert inside.all() and found == pytest.approx(shape, abs=1e-12)
        assert not facets.weights(nodes[None], facets.hull(nodes[None]).max(axis=1) + 0.01)[1].any()


def rail(bulge: float, divisions=(2, 1, 2)) -> RailMesh:
    """Block in the path of the payload's mass centre, the middles of its touched face y = 0 drawn
    out by ``bulge`` (m)."""
    mesh = tets.split(block(divisions, (WIDTH, WIDTH, WIDTH)))
    outside, points = boundary_facets(mesh.cells), mesh.points - [0.5 * WIDTH, 0.0, 0.5 * WIDTH]
    touched, far = (
        outside[(points[outside][:, :, 1] == place).all(axis=1)] for place in (0.0, WIDTH)
    )
    points[touched[:, 3:], 1] -= bulge
    return RailMesh(points, mesh.cells, {"contact_y": touched, "mount": far})


def pressed(mesh, depth, numerics=Numerics()):
    """Force (N) on a payload whose face stands ``depth`` (m) beyond the plane y = 0, and the
    loop."""
    found = scene(1.0, 0.0, INTERFACE_STIFFNESS, 1e-4, 1e-6).replace(
        {"initial.position.y": GAP + depth}
    )
    system = build(found, numerics, mesh)
    loop = Loop(set_up(found, system, choose(system, found, numerics)))
    loop.begin()
    return np.array(loop.recorded.forces)[0, 0], loop


def test_a_bulge_is_touched_before_the_corners_are():
    """Control: a wall without the bulge is not touched there."""
    bulge = 2e-6
    force, _ = pressed(rail(bulge), -0.5 * bulge)
    assert force[1] < -1.0
    flat, _ = pressed(rail(0.0), -0.5 * bulge)
    assert not flat.any()
    outside, _ = pressed(rail(bulge), -3.0 * bulge)
    assert not outside.any()


@pytest.mark.parametrize("cells, error", [(7, 0.03), (21, 0.01), (16, 1e-9), (None, 1e-9)])
def test_an_even_press_gives_pressure_times_area(cells, error):
    """k p A on the payload, and its opposite on the rail, where the corners of triangles may carry
    negative shares. At each corner of the wall up to a fifth of a cell is too much, unless cells end
    there."""
    depth = 1e-6
    force, loop = pressed(rail(0.0), depth, Numerics(cells=cells))
    push = INTERFACE_STIFFNESS * depth * WIDTH**2
    assert force[1] == pytest.approx(-push, rel=error)
    # k p^2 / 2 along each edge of the wall: all of it or none, where cells end at the edge.
    assert np.abs(force[[0, 2]]).max() <= 0.501 * INTERFACE_STIFFNESS * depth**2 * WIDTH
    total = -loop.stepper.state.resistance.sum(axis=0)
    assert total == pytest.approx([0.0, -force[1], 0.0], rel=1e-9, abs=1e-9)


def contact_share(system) -> np.ndarray:
    """M^-1/2 G k G' M^-1/2 (n,n) of all cells of the pad over the rail, along the normal."""
    surface, mass = system.surface, system.rail.mass
    root = np.where(system.rail.inverse_mass > 0.0, np.sqrt(system.rail.inverse_mass), 0.0)
    matrix, count = np.zeros((mass.size, mass.size)), int(surface.cells[0, 0])
    middles = WIDTH * (2.0 * np.arange(count) + 1.0 - count) / count  # the pad is twice as wide
    over = middles[np.abs(middles) < 0.5 * WIDTH]
    places = np.stack(np.meshgrid(over, over), axis=-1).reshape(-1, 2)
    left = np.ones(len(places), dtype=bool)
    for nodes in surface.facets:
        plane = np.broadcast_to(surface.places[nodes][:, [0, 2]], (left.sum(), 6, 2))
        values, inside = facets.weights(plane, places[left])
        left[np.flatnonzero(left)[inside]] = False
        part = values[inside].T @ values[inside] * (2.0 * WIDTH / count) ** 2
        np.add.at(matrix, (nodes[:, None], nodes), part)
    assert not left.any()
    return system.model.interface_stiffness * root[:, None] * matrix * root


@pytest.mark.parametrize("divisions", [(1, 1, 1), (2, 1, 2), (3, 4, 3)])
def test_the_bound_on_contact_stiffness_holds(divisions):
    """The bound is at most 3.5 times the stiffness."""
    system = build(
        scene(1e9, 0.0, INTERFACE_STIFFNESS, 1e-4, 1e-6), Numerics(), rail(0.0, divisions)
    )
    highest = np.linalg.eigvalsh(contact_share(system))[-1]
    assert highest <= contact_frequency_squared(system) <= 3.5 * highest


def test_points_between_nodes_can_be_faster_than_nodes():
    """At most 5/3 as fast, at the centre of a triangle."""
    system = build(scene(1.0, 0.0, INTERFACE_STIFFNESS, 1e-4, 1e-6), Numerics(), rail(0.0))
    shape, _ = facets.gauss(TRIANGLE[None], 12)
    assert 1.6 < np.abs(shape).sum(axis=1).max() <= magnification(system.surface) <= 5.0 / 3.0
