"""Statics of compliant contact: one potential of all forces, one solution, and agreement with the
finite elements of the compliance."""

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from tests.lowfi.compliance import (
    BASES,
    CELLS,
    CLEARANCE,
    POSES,
    REFERENCE,
    SMOOTH,
    derivative,
    energy,
    flexibility_at,
    forces_of,
    generalised,
    pose_of,
    pressed,
    reference_compliance,
    relative,
    seen_from_platform,
    solved,
    state_of,
)
from tipoff.highfi.contact import surface
from tipoff.highfi.mesh import facets, pieces
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.simulation import prepare
from tipoff.highfi.statics import assembly
from tipoff.kernels import rotation
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import cells, deepest, solution, step_limit
from tipoff.lowfi.contact.compliant.record import ASIDE, BY_ETA, BY_XI, DEPTH, PART, SHIFT, SPAN
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.scenes import scene_model


@pytest.fixture(scope="module")
def reference():
    """Rail compliance, model, records."""
    compliance = reference_compliance()
    return compliance, *pressed(REFERENCE.replace(SMOOTH), compliance)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("name", POSES)
def test_forces_are_the_gradient_of_the_energy(reference, name, base):
    """dE = -forces . twist for each way either body can move, over an end of the rail too. E is a
    quadratic between kinks of its slope."""
    _, model, system = reference
    pose, h = pose_of(model, name, BASES[base]), 1e-9
    twists = np.eye(12)
    out = [derivative(system, model, pose, twist) for twist in twists]
    forces = generalised(pose, out[0])
    slopes = np.array(
        [
            (
                energy(system, model, pose.moved(twist, h))
                - energy(system, model, pose.moved(twist, -h))
            )
            / (2.0 * h)
            for twist in twists
        ]
    )
    size = np.abs(forces).max()
    assert size > 20.0
    assert slopes == pytest.approx(-forces, abs=1e-7 * size, rel=0.0)
    assert not any(each[slot.RELEASED] for each in out)
    # Control: without what acts along the rail, which is softer or stiffer ahead and ends, they would
    # not agree.
    axes = rotation.matrix(pose.base_attitude)
    assert abs(rotation.unrotate(axes, tuple(forces[:3]))[0]) > 1e-6 * size


def spectrum(system, model, pose):
    """Stiffness per mass (12,12) 1/s2, from differences of the forces."""
    metric, h = np.zeros((12, 12)), 1e-9
    for first, body in ((0, model.payload), (6, model.platform)):
        metric[first : first + 3, first : first + 3] = np.eye(3) / body.mass
        metric[first + 3 : first + 6, first + 3 : first + 6] = body.inverse_inertia
    change = np.zeros((12, 12))
    for column, twist in enumerate(np.eye(12)):
        there, back = (pose.moved(twist, sign * h) for sign in (1.0, -1.0))
        change[:, column] = (
            generalised(there, derivative(system, model, there, 0.0 * twist))
            - generalised(back, derivative(system, model, back, 0.0 * twist))
        ) / (2.0 * h)
    return -metric @ change


def limits(system, model, pose):
    """Bounds of stiffness (1/s2) and damping (1/s) per mass."""
    return step_limit.stiffness_and_damping(
        system.compliance,
        system.friction,
        system.faces,
        system.platform,
        system.payload,
        np.ones(len(system.faces), dtype=np.bool_),
        state_of(model, pose),
        False,
    )


@pytest.mark.parametrize("name", POSES)
def test_tangent_bounds_the_change_of_the_forces(reference, name):
    """Trace of M^-1 T against differences of the forces. The rest, from the arms of the forces and
    the slopes of the walls, is a few thousandths of it."""
    _, model, system = reference
    pose = pose_of(model, name, BASES["moved and turned"])
    springs, dampers = limits(system, model, pose)
    assert springs == pytest.approx(np.trace(spectrum(system, model, pose)), rel=4e-3)
    assert dampers == 0.0


@pytest.mark.parametrize("name", POSES)
def test_one_solution_whatever_the_first_guess(reference, name):
    """U = F P(U) by the plain equations; a zero, a random and the right first guess give the same
    walls."""
    compliance, model, system = reference
    pose, workspace = pose_of(model, name), system.compliance.workspace
    random = np.random.default_rng(8)
    flexibility = flexibility_at(compliance, POSES[name][0])
    for rail in range(len(system.compliance.members)):
        found = []
        for guess in (0.0, 3e-4 * random.standard_normal(workspace.displacement.shape), None):
            if guess is not None:
                workspace.displacement[:] = guess
            count = solved(system, model, pose, rail)
            faces = workspace.order[:count]
            found.append(workspace.displacement[faces].copy())
            force = workspace.force[faces]
            between = flexibility[np.ix_(faces, range(PATTERNS), faces, range(PATTERNS))]
            assert found[-1] == pytest.approx(np.einsum("iajb,jb->ia", between, force), abs=1e-17)
        assert all(np.abs(each - found[0]).max() < 1e-16 for each in found)
        if "over" not in name:
            expected = [
                forces_of(compliance, model, CELLS, face, pose, each)
                for face, each in zip(faces, found[0])
            ]
            assert force == pytest.approx(
                np.array(expected), rel=1e-9, abs=1e-9 * np.abs(force).max()
            )


def test_a_pose_that_is_not_finite_leaves_nothing_behind(reference):
    """A trial step may end anywhere; a shorter one must find the same walls as without it."""
    _, model, system = reference
    pose, workspace = pose_of(model, "both legs"), system.compliance.workspace
    every = np.ones(len(system.faces), dtype=np.bool_)
    solved(system, model, pose, 0)
    force = workspace.force.copy()
    place, turn = seen_from_platform(system.platform, system.payload, state_of(model, pose))
    for lost in (np.nan, np.inf):
        for bad in ((lost, *place[1:]), (place[0], lost, lost)):
            arguments = (system.faces, 0, every, bad, turn, np.zeros(0))
            solution.solve(system.compliance, *arguments)
            solved(system, model, pose, 0)
            np.testing.assert_allclose(workspace.force, force, rtol=1e-9, atol=1e-9)


def test_any_pose_is_solved(reference):
    """From first touch to millimetres deep, also over the ends, from random guesses: the forces are
    those of the displacements."""
    _, model, system = reference
    random, workspace, worst = np.random.default_rng(1), system.compliance.workspace, 0.0
    for size in 10.0 ** random.uniform(-7.0, -2.7, 500):
        offset = random.choice((-1.0, 1.0), 2) * CLEARANCE + size * random.standard_normal(2)
        pose = relative(
            model, random.uniform(-0.01, 0.22), offset, 5.0 * size * random.standard_normal(3)
        )
        for rail in range(len(system.compliance.members)):
            workspace.displacement[:] = size * random.standard_normal(workspace.displacement.shape)
            faces = workspace.order[: solved(system, model, pose, rail)]
            alone = workspace.force[faces].copy()
            for face in faces:
                cells.press(system.compliance, face)
            worst = max(
                worst,
                np.abs(workspace.force[faces] - alone).max(initial=0.0)
                / max(np.abs(alone).max(initial=0.0), 1e-3),
            )
    assert worst < 1e-12


def test_the_deepest_cell_of_a_wall_at_rest(reference):
    """By rows and columns alone it is the one that a search of all cells finds, also past the
    ends."""
    _, model, system = reference
    random, compliance = np.random.default_rng(2), system.compliance
    nothing = np.zeros(PATTERNS)
    for size in 10.0 ** random.uniform(-7.0, -2.7, 200):
        offset = random.choice((-1.0, 1.0), 2) * CLEARANCE + size * random.standard_normal(2)
        pose = relative(
            model, random.uniform(-0.01, 0.22), offset, 5.0 * size * random.standard_normal(3)
        )
        state = state_of(model, pose)
        place, turn = seen_from_platform(system.platform, system.payload, state)
        for face in range(len(system.faces)):
            cells.take_lever(compliance, system.faces, face, place, turn)
            depth, *where = deepest.deepest(compliance, face, nothing)
            found, *there = deepest.deepest_at_rest(compliance, face, nothing)
            assert found == depth and there == where


def depths(compliance, face, displacement):
    """p (c, c) m of all cells of a face in rows along xi, and xi (c,) of the rows, by arrays."""
    lever, node = compliance.workspace.lever[face], compliance.node
    middle, span = (lever[PART], lever[SPAN]) if lever[SPAN] else (0.0, 1.0)
    xi, half = middle + span * node, span / node.size
    ahead, beyond = (xi + lever[SHIFT])[:, None], (node + lever[ASIDE])[None]
    powers = [(n - j, j) for n in range(6) for j in range(n + 1)][: displacement.size]
    wall = sum(u * ahead**i * beyond**j for u, (i, j) in zip(displacement, powers))
    crown = ((xi + half) ** 5 - (xi - half) ** 5)[:, None] / (10.0 * half) + compliance.crown[None]
    flat = lever[DEPTH] + lever[BY_XI] * xi[:, None] + lever[BY_ETA] * node[None]
    return flat - compliance.relief[face] * crown - wall, xi


def test_the_deepest_cell_of_a_bent_wall(reference):
    """It is the one that arrays of all cells find, where it is in any row. Control: the row that is
    deepest in its middle often has another one."""
    _, model, system = reference
    random, compliance, others = np.random.default_rng(3), system.compliance, 0
    for size in 10.0 ** random.uniform(-7.0, -3.0, 100):
        offset = random.choice((-1.0, 1.0), 2) * CLEARANCE + size * random.standard_normal(2)
        pose = relative(
            model, random.uniform(-0.01, 0.22), offset, 5.0 * size * random.standard_normal(3)
        )
        place, turn = seen_from_platform(system.platform, system.payload, state_of(model, pose))
        for face in range(len(system.faces)):
            cells.take_lever(compliance, system.faces, face, place, turn)
            bent = size * random.standard_normal(PATTERNS)
            depth, along, across = deepest.deepest(compliance, face, bent)
            p, xi = depths(compliance, face, bent)
            row, column = np.argmin(np.abs(xi - along)), np.argmin(np.abs(compliance.node - across))
            assert depth == pytest.approx(p.max(), abs=1e-15)
            assert p[row, column] == pytest.approx(p.max(), abs=1e-15)
            others += p[np.argmax(p[:, compliance.node.size // 2])].max() < p.max()
    assert others > 100


def pressed_elements(scene, face, travel, aside=0.0, points_per_edge=4):
    """Force (N) as a function of the depth (m) a crowned pad face is pressed into the rail of
    elements of 4 mm, ``aside`` (m) of where it stands midway between the rails: interface stiffness
    at Gauss points of each facet, each one's pressure felt at every other, by Newton's rule with
    the points that touch."""
    nominal = scene_model.built(scene).nominal
    faces = nominal._replace(
        wall=nominal.wall + np.array(scene.platform.record().mass_centre)[nominal.axis]
    )
    axis, across, sign, material = (
        faces.axis[face],
        3 - faces.axis[face],
        faces.sign[face],
        scene.rail.material,
    )
    for rail in pieces.pieces(prepare(scene, Numerics(element_size=4e-3))):
        wall = np.concatenate(
            [group for name, group in rail.surfaces.items() if name.startswith("contact")]
        )
        wall = wall[surface.in_reach(rail.points[wall], faces, face)]
        if wall.size:
            break
    shape, area = facets.gauss(rail.points[wall], points_per_edge)
    points = np.einsum("qk,mki->mqi", shape, rail.points[wall])[:, :, [0, across]]
    local = (points - faces.centre[face, [0, across]] - [travel, aside]) / [
        faces.half_length[face],
        faces.half_width[face],
    ]
    where, which = np.nonzero((np.abs(local) < 1.0).all(axis=2))
    spring, crown = (
        scene.contact.interface_stiffness * area[where, which],
        faces.relief[face] * (local[where, which] ** 4).sum(axis=1),
    )
    nodes, place = np.unique(wall[where], return_inverse=True)
    seen = np.zeros((spring.size, nodes.size))
    np.put_along_axis(seen, place.reshape(len(where), -1), sign * shape[which], axis=1)
    operator = assembly.of_material(rail, material)
    assert operator.free[nodes].all()
    free = np.repeat(operator.free, 3)
    unit = np.zeros((free.size, nodes.size))  # one force at each node that the pad can load
    unit[3 * nodes + axis, np.arange(nodes.size)] = 1.0
    moved = np.zeros_like(unit)
    moved[free] = splu(assembly.sparse(operator)[free][:, free].tocsc()).solve(unit[free])
    compliance = moved[3 * nodes + axis]

    def force(depth):
        touching, before = crown < depth, None
        while before is None or (before != touching).any():
            loading = compliance @ (seen.T * (spring * touching))
            moved = seen @ np.linalg.solve(
                np.eye(nodes.size) + loading @ seen, loading @ (depth - crown)
            )
            before, touching = touching, depth - crown > moved
        return float((spring * before) @ (depth - crown - moved))

    return force


@pytest.mark.parametrize(
    "travel, error", [(0.008, 0.05), (0.056, 0.025)], ids=["at a mount", "between mounts"]
)
def test_force_is_that_of_the_finite_elements(reference, travel, error):
    """One pad: pressure in six patterns on ten by ten cells against a pressure that is free at
    every point. Nothing is fitted. At a mount only the leg's own bending is left, which the
    patterns describe less well."""
    compliance, model, system = reference
    face, force = 0, pressed_elements(REFERENCE, 0, travel)
    active = np.arange(len(system.faces)) == face
    for depth in (2e-6, 5e-6, 1e-5, 2e-5):
        offset = np.zeros(2)
        offset[model.faces.axis[face] - 1] = model.faces.sign[face] * (CLEARANCE + depth)
        pose = relative(model, travel, offset)
        assert solved(system, model, pose, compliance.rail[face], active) == 1
        assert system.compliance.workspace.force[face, 0] == pytest.approx(force(depth), rel=error)
        # Control: a rigid wall would press back three times as hard, or more.
        assert forces_of(compliance, model, CELLS, face, pose, np.zeros(PATTERNS))[0] > 3.0 * force(
            depth
        )


@pytest.mark.parametrize(
    "aside", [CLEARANCE, -CLEARANCE], ids=["to the free edge", "to the corner"]
)
def test_a_pad_aside_meets_a_softer_or_stiffer_leg(reference, aside):
    """The force is that of finite elements under the pad at its real place, though the compliance
    was found midway between the rails."""
    compliance, model, system = reference
    face, travel, depth = 0, 0.056, 2e-5
    active = np.arange(len(system.faces)) == face
    axis = model.faces.axis[face]

    def force(way):
        offset = np.zeros(2)
        offset[axis - 1], offset[2 - axis] = model.faces.sign[face] * (CLEARANCE + depth), way
        solved(system, model, relative(model, travel, offset), compliance.rail[face], active)
        return system.compliance.workspace.force[face, 0]

    expected = [pressed_elements(REFERENCE, face, travel, way, 16)(depth) for way in (0.0, aside)]
    change = expected[1] / expected[0] - 1.0
    assert abs(change) > 0.02  # control: what would be missed
    assert force(aside) / force(0.0) - 1.0 == pytest.approx(change, abs=0.1 * abs(change))
