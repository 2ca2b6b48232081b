"""Uneven temperature: free bodies bow without stress, held ones have the stress of the closed
forms, and a rail beyond its mounts bows as a strip."""

from dataclasses import replace

import numpy as np
import pytest

from tests.exact import thermal as exact
from tests.highfi import tets
from tests.highfi.blocks import ALUMINIUM, block, static
from tipoff import scenes
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.highfi.statics import assembly, thermal
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.laws.thermal import Thermal
from tipoff.meshes import l_rail
from tipoff.scenes.rail_base import MaterialTable

MATERIAL = MaterialTable.model_validate(ALUMINIUM, context={"bare_numbers_are_si": True})
EXPANSION, LENGTH, WIDTH, HEIGHT = 23.6e-6, 0.2, 0.012, 0.016
WARMER = EXPANSION * 20.0  # free strain of 20 K
UPWARD = np.array([0.0, 0.0, EXPANSION * 2000.0])  # 1/m, of 2 K/mm through the height


def strip(kind="hex", divisions=(20, 2, 2)):
    mesh = block(divisions, (LENGTH, WIDTH, HEIGHT))
    return tets.split(mesh) if kind == "tet" else mesh


def operator_of(mesh):
    return assembly.build(mesh, **ALUMINIUM)


def free_answer(mesh, strain, operator=None):
    """Displacement (n,3) m by the free strain (n,) at the nodes, held at three of them without a
    load on any."""
    operator = operator or operator_of(mesh)
    held, (x, y, z) = np.zeros(mesh.points.shape, dtype=bool), mesh.points.T
    for place, axes in (
        ((0.0, 0.0, 0.0), (0, 1, 2)),
        ((LENGTH, 0.0, 0.0), (1, 2)),
        ((0.0, WIDTH, 0.0), (2,)),
    ):
        held[np.flatnonzero((x == place[0]) & (y == place[1]) & (z == place[2]))[0], list(axes)] = (
            True
        )
    return static(operator, thermal.loads(mesh, operator, MATERIAL, strain[:, None])[..., 0], held)


def without_rigid_motion(points, displacement):
    """What is left of a displacement after the nearest rigid motion."""
    motions = np.zeros((*points.shape, 6))
    for axis in range(3):
        motions[:, axis, axis] = 1.0
        motions[:, :, 3 + axis] = np.cross(np.eye(3)[axis], points - points.mean(axis=0))
    flat = motions.reshape(-1, 6)
    return (
        displacement.ravel() - flat @ np.linalg.lstsq(flat, displacement.ravel(), rcond=None)[0]
    ).reshape(-1, 3)


@pytest.mark.parametrize("kind", ["hex", "tet"])
@pytest.mark.parametrize(
    "gradient", [UPWARD, EXPANSION * np.array([300.0, -700.0, 2000.0])], ids=["height", "oblique"]
)
def test_a_free_strip_bows_without_stress(kind, gradient):
    """Every node is where the exact field places it: curvature alpha dT / h, the anticlastic bow
    across the width, and the growth."""
    mesh = strip(kind)
    wanted = without_rigid_motion(
        mesh.points, exact.free_displacement(mesh.points, WARMER, gradient)
    )
    found = without_rigid_motion(mesh.points, free_answer(mesh, WARMER + mesh.points @ gradient))
    assert np.abs(found - wanted).max() < 1e-8 * np.abs(wanted).max()
    # Control: with the gradient the other way round, it would be elsewhere.
    reverse = without_rigid_motion(
        mesh.points, exact.free_displacement(mesh.points, WARMER, -gradient)
    )
    assert np.abs(found - reverse).max() > 0.5 * np.abs(wanted).max()


def test_curvature():
    """Heights of the middle line of the free strip: -k x^2 / 2 with k = alpha dT / h, away from the
    warm side."""
    mesh, curvature = strip(), EXPANSION * (2000.0 * HEIGHT) / HEIGHT
    x, y, z = mesh.points.T
    line = np.flatnonzero((y == 0.0) & (z == 0.0))
    bow = free_answer(mesh, mesh.points @ UPWARD)[line, 2]
    assert np.diff(bow, 2) / np.diff(x[line])[0] ** 2 == pytest.approx(-curvature, rel=1e-7)


def test_plain_bubbles_would_bend_the_strip_otherwise(monkeypatch):
    """Control: loads without the part of the bubbles give a curvature that is off by more than a
    tenth."""
    mesh, formulation = strip(divisions=(20, 1, 1)), hexahedron
    direct = formulation.expansion

    def on_corners_only(corners, law):
        strain = formulation.kinematics(formulation.basis(corners))
        shape = formulation.shape_functions(formulation.basis(corners))
        return np.einsum(
            "cqsd,s,aq,cq->cda", strain.nodal, law[:, :3].sum(axis=1), shape, strain.volume
        )

    wanted = without_rigid_motion(mesh.points, exact.free_displacement(mesh.points, 0.0, UPWARD))
    errors = []
    for formula in (direct, on_corners_only):
        monkeypatch.setattr(formulation, "expansion", formula)
        errors.append(
            np.abs(
                without_rigid_motion(mesh.points, free_answer(mesh, mesh.points @ UPWARD)) - wanted
            ).max()
        )
    assert errors[0] < 1e-8 * np.abs(wanted).max() < 0.1 * np.abs(wanted).max() < errors[1]


@pytest.mark.parametrize("kind", ["hex", "tet"])
def test_uniform_growth_of_distorted_elements(kind):
    """A patch test: u = e X at every node of a free body, whatever the shape of its elements."""
    mesh = strip("hex", (6, 2, 2))
    inside = ((mesh.points > 0.0) & (mesh.points < [LENGTH, WIDTH, HEIGHT])).all(axis=1)
    points = mesh.points.copy()
    points[inside] += 1.5e-3 * np.random.default_rng(5).uniform(-1.0, 1.0, (inside.sum(), 3))
    mesh = replace(mesh, points=points)
    mesh = tets.split(mesh) if kind == "tet" else mesh
    found = free_answer(mesh, np.full(len(mesh.points), WARMER))
    assert (
        np.abs(without_rigid_motion(mesh.points, found - WARMER * mesh.points)).max()
        < 1e-10 * WARMER * LENGTH
    )


@pytest.mark.parametrize("held", [1, 2, 3])
def test_held_bar(held):
    """Between two walls, four, or six: the force on the wall at x = 0 is A E e / (1 - (held - 1)
    nu), the bar growing freely across."""
    mesh = strip(divisions=(4, 2, 2))
    operator = operator_of(mesh)
    fixed = np.zeros(mesh.points.shape, dtype=bool)
    for axis, size in zip(range(3), (LENGTH, WIDTH, HEIGHT)):
        place = mesh.points[:, axis]
        fixed[:, axis] = (place == 0.0) | ((place == size) & (axis < held))
    load = thermal.loads(mesh, operator, MATERIAL, np.full((len(mesh.points), 1), WARMER))[..., 0]
    found = static(operator, load, fixed)
    reaction = (assembly.sparse(operator) @ found.ravel()).reshape(-1, 3) - load
    force = reaction[mesh.points[:, 0] == 0.0, 0].sum()
    wanted = (
        -exact.clamped_stress(ALUMINIUM["youngs_modulus"], ALUMINIUM["poisson_ratio"], WARMER, held)
        * WIDTH
        * HEIGHT
    )
    assert force == pytest.approx(wanted, rel=1e-9)


def on_a_clamp(gradient, element_size=0.004):
    """Mesh and displacement of an L rail of 24 mm legs, held over its first 40 mm, 200 mm beyond,
    whose outer corner, by which it is held, is no warmer than when it was mounted: else the rail
    would grow out of the clamp at an angle."""
    geometry = l_rail.LRailGeometry(0.024, 0.004, 0.0, 0.24, 0.1, 0.1, ((0.0, 0.04),), 0.004)
    mesh = read(l_rail.build(geometry, element_size))
    amounts = EXPANSION * np.array([-gradient[1:].sum() * mesh.points[:, 1].max(), *gradient, 0.0])
    return mesh, thermal.displacement(mesh, MATERIAL, Thermal(amounts, 0.12))


def test_rail_beyond_its_mount_bows_as_a_strip():
    """The L section is free of stress a leg's length away from the clamp, so the line of its outer
    corner has the curvature alpha dT / h in both planes. A clamp that holds only the corner lets
    the legs bow within it: the end is displaced by k L^2 / 2 of a
    strip that is up to a leg longer."""
    gradient = np.array([0.0, 500.0, -200.0])
    mesh, found = on_a_clamp(gradient)
    x, y, z = mesh.points.T
    corner = np.flatnonzero((y == y.max()) & (z == z.max()))  # of the rail at +y +z
    corner = corner[np.argsort(x[corner])]
    for axis in (1, 2):
        bow, curvature = found[corner, axis], -EXPANSION * gradient[axis]
        beyond = x[corner] > 0.07
        assert np.diff(bow[beyond], 2) / 0.004**2 == pytest.approx(curvature, rel=0.005)
        assert (
            1.0
            < bow[-1] / exact.bow(curvature, 0.2)
            < exact.bow(curvature, 0.224) / exact.bow(curvature, 0.2)
        )
    other = on_a_clamp(-gradient)[1]
    # the other way round it bows the other way
    assert np.abs(other + found).max() < 1e-9 * np.abs(found).max()


@pytest.fixture(scope="module")
def rails():
    return make_mesh(scenes.load("tiny"), 0.008)


def test_rails_that_grow_with_their_platform_are_free_of_stress(rails):
    """u = s (X - X_m) at every node of all four rails, and no force at any mount; with a platform
    that stays there is one."""
    material, middle = scenes.load("tiny").rail.material, 0.024
    together = Thermal(np.array([WARMER, 0.0, 0.0, 0.0, WARMER]), middle)
    found = thermal.displacement(rails, material, together)
    wanted = WARMER * (rails.points - [middle, 0.0, 0.0])
    assert np.abs(found - wanted).max() < 1e-10 * np.abs(wanted).max()
    alone = thermal.displacement(
        rails, material, together._replace(amounts=np.array([WARMER, 0.0, 0.0, 0.0, 0.0]))
    )
    assert np.abs(alone - wanted).max() > 0.1 * np.abs(wanted).max()
    assert not alone[np.unique(rails.surfaces["mount"])].any()


def test_each_field_by_itself_and_all_together(rails):
    """Linear in the amounts; mirrored rails answer mirrored fields."""
    material, amounts = (
        scenes.load("tiny").rail.material,
        EXPANSION * np.array([20.0, 50.0, 100.0, -70.0, 3.0]),
    )
    whole = thermal.displacement(rails, material, Thermal(amounts, 0.024))
    parts = sum(
        thermal.displacement(rails, material, Thermal(amounts * row, 0.024)) for row in np.eye(5)
    )
    assert np.abs(whole - parts).max() < 1e-9 * np.abs(whole).max()
    assert not thermal.displacement(rails, material, Thermal(np.zeros(5), 0.024)).any()
    order = np.lexsort(np.round(1e6 * rails.points).T)
    mirror = np.lexsort(np.round(1e6 * rails.points * [1.0, -1.0, 1.0]).T)
    mirrored = thermal.displacement(
        rails, material, Thermal(amounts * [1.0, 1.0, -1.0, 1.0, 1.0], 0.024)
    )
    assert (
        np.abs(mirrored[mirror] * [1.0, -1.0, 1.0] - whole[order]).max()
        < 1e-9 * np.abs(whole).max()
    )


def test_a_rail_that_nothing_holds_is_refused(rails):
    loose = replace(rails, surfaces=rails.surfaces | {"mount": rails.surfaces["mount"][:0]})
    with pytest.raises(ValueError, match="no mount"):
        thermal.displacement(loose, MATERIAL, Thermal(np.zeros(5), 0.0))


def test_held_nodes_go_where_they_are_brought():
    mesh = strip(divisions=(4, 1, 1))
    clamped = Clamped(operator_of(mesh))
    turn = np.cross([0.1, -0.2, 0.3], mesh.points).reshape(-1, 1)
    assert (
        np.abs(
            clamped.displaced(np.zeros_like(turn), np.where(clamped.free[:, None], 0.0, turn))
            - turn
        ).max()
        < 1e-12
    )
