"""The fillet of the built-in section: exact area, good elements, borders of walls and mounts, and
pads beside it."""

import math

import numpy as np
import pytest

from tipoff import scenes
from tipoff.highfi.mesh.cells import corner_jacobians
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.rail import step_cost
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.meshes import fillet, l_rail
from tipoff.scenes.rail import LARGEST_FILLET

GEOMETRY = l_rail.LRailGeometry(fillet=0.002)
LENGTH = 0.220  # m
SHARP = 176e-6  # m2, section without a fillet


def volume(mesh):
    """m3, exact for prisms: their Jacobian is bilinear in the section and constant along X."""
    return corner_jacobians(mesh.points, mesh.cells)[0].mean(axis=1).sum()


def around(mesh, geometry):
    """Distances (n,) m of the nodes of the fillet from its centre, without its ends."""
    inside = geometry.thickness + geometry.fillet
    depths = inside + geometry.inner_corner_y - geometry.fillet - np.abs(mesh.points[:, 1:])
    distance = np.linalg.norm(inside - depths, axis=1)
    within = (depths.max(axis=1) < inside - 1e-9) & (depths.min(axis=1) > geometry.thickness + 1e-9)
    return distance[within]


@pytest.mark.parametrize("size", [0.008, 0.004, 0.003, 0.002, 0.001])
@pytest.mark.parametrize("change", [{}, {"fillet": 0.005}, {"thickness": 0.003}])
def test_area_of_a_fillet(size, change):
    """(1 - pi / 4) r^2 of metal more than a sharp corner. Control: the polygon through points of
    the arc has up to a third more."""
    geometry = GEOMETRY._replace(x_start=0.0, x_end=0.016, mount_spans=((0.0, 0.008),), **change)
    mesh = read(l_rail.build(geometry, size))
    sharp = read(l_rail.build(geometry._replace(fillet=0.0), size))
    exact = (1.0 - 0.25 * math.pi) * geometry.fillet**2
    more = (volume(mesh) - volume(sharp)) / (4.0 * 0.016)
    assert more == pytest.approx(exact, rel=1e-9)
    assert len(mesh.cells) == l_rail.elements(geometry, size)
    chords = 2 * l_rail.divisions(geometry.fillet, size)
    inscribed = 1.0 - 0.5 * chords * math.sin(0.5 * math.pi / chords)
    assert inscribed * geometry.fillet**2 > (1.0 + 0.7 / chords**2) * exact


@pytest.mark.parametrize("size", [0.004, 0.001])
def test_nodes_approach_the_arc_with_the_second_power_of_the_size(size):
    """For chords of angle v, the area between chord and arc is r^2 v^3 / 12. Divided by the change of
    the area with the radius of the n - 1 inner corners, it is r v^2 / 12 n / (n - 1)."""
    chords = 2 * l_rail.divisions(GEOMETRY.fillet, size)
    angle = 0.5 * math.pi / chords
    away = around(read(l_rail.build(GEOMETRY, size)), GEOMETRY) / GEOMETRY.fillet - 1.0
    assert away == pytest.approx(angle**2 / 12.0 * chords / (chords - 1), rel=0.1)


def test_walls_end_at_the_fillet_and_mounts_stay():
    mesh, sharp = (
        read(l_rail.build(each, 0.002)) for each in (GEOMETRY, GEOMETRY._replace(fillet=0.0))
    )
    for name, axis in (("contact_y", 1), ("contact_z", 2)):
        corners = np.abs(mesh.points[mesh.surfaces[name]])
        assert corners[..., axis] == pytest.approx(0.10025, abs=1e-12)
        assert corners[..., 3 - axis].max() == pytest.approx(0.10025 - 0.002, abs=1e-12)
        assert corners[..., 3 - axis].min() == pytest.approx(0.10025 - 0.020, abs=1e-12)
    places = [
        np.unique(np.round(each.points[each.surfaces["mount"]].reshape(-1, 3), 9), axis=0)
        for each in (mesh, sharp)
    ]
    assert np.array_equal(*places)


def test_rails_with_fillets_are_mirror_images_to_the_last_bit():
    built = l_rail.build(GEOMETRY, 0.004)
    rails = built.points.reshape(4, -1, 3)
    assert all(np.array_equal(np.abs(rail), np.abs(rails[0])) for rail in rails)


@pytest.mark.parametrize("size", [0.008, 0.004, 0.002, 0.001, 0.0005])
@pytest.mark.parametrize("radius", [0.001, 0.002, 0.004, 0.005])
def test_elements_around_a_fillet_are_no_slivers_and_not_skewed(size, radius):
    """Scaled Jacobian above the limit of the warning, 0.85, for every radius and size. Only a fillet of
    1 mm is so small relative to elements of 4 mm that there are slivers, with a warning."""
    small = radius == 0.001 and size >= 0.004
    geometry = GEOMETRY._replace(
        fillet=radius, x_start=0.0, x_end=2.0 * size, mount_spans=((0.0, size),)
    )
    mesh = read(l_rail.build(geometry, size))
    assert corner_jacobians(mesh.points, mesh.cells)[1].min() > 0.86
    assert ["slivers" in words for words in mesh.warnings] == [True] * small


@pytest.mark.parametrize("size, factor", [(0.004, 1.70), (0.002, 1.05), (0.001, 1.10)])
def test_a_fillet_of_2_mm_costs_few_steps(size, factor):
    scene = scenes.load("reference")
    geometry = GEOMETRY._replace(x_start=0.0, x_end=2.0 * size, mount_spans=((0.0, size),))
    mesh = read(l_rail.build(geometry, size))
    found = step_cost.ratio(scene.rail.material, size, mesh.points, mesh.cells)
    assert factor - 0.05 < found < factor


@pytest.mark.parametrize(
    "change", [{"fillet": 0.0051}, {"fillet": -0.001}, {"leg": 0.007, "fillet": 0.003}]
)
def test_impossible_fillets_are_refused(change):
    with pytest.raises(ValueError, match="need a fillet"):
        l_rail.build(GEOMETRY._replace(**change), 0.004)


def test_scene_and_mesh_have_the_same_limit():
    assert LARGEST_FILLET == fillet.LARGEST


def test_pads_on_a_fillet_are_bad_input():
    """Those of the scene end where its fillet of 2 mm begins, in any unit."""
    scene = scenes.load("reference")
    for radius in ("2 mm", "0.2 cm"):
        make_mesh(scene.replace({"rail.fillet": radius}), 0.008)
    with pytest.raises(scenes.SceneError) as error:
        make_mesh(scene.replace({"rail.fillet": "2.01 mm"}), 0.008)
    (fault,) = error.value.faults
    assert fault.key == "rail.fillet"
    assert fault.given == ("0.00201 m, with pads from 0.002 m on (inset less half of the width)")
    with pytest.raises(scenes.SceneError, match="larger inset"):
        make_mesh(scene.replace({f"pads.{pad}.inset": "9 mm" for pad in range(8)}), 0.008)
