"""Compliance of the walls under pads: a beam with a closed form, reciprocity, scaling, mirror
images, refinement, and properties of a rail on three mounts."""

from dataclasses import replace

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import block
from tipoff import scenes
from tipoff.highfi import compliance
from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import MeshError, boundary_facets
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.highfi.statics import pressure, wall_grid
from tipoff.highfi.statics.held import distinct
from tipoff.mechanics.model import Faces
from tipoff.scenes.rail_base import MaterialTable

LENGTH, WIDTH, HEIGHT, MODULUS = 0.6, 0.03, 0.04, 72e9
HALF = 0.03  # m along the beam
AT_MOUNT, BETWEEN, AT_END = 0.102, 0.056, 0.204  # travel (m) that brings the rear pads there
TRAVEL = (AT_MOUNT, BETWEEN, AT_END)


def beam(divisions=(40, 2, 4)):
    """Clamped at x = 0, its top a wall."""
    mesh = block(divisions, (LENGTH, WIDTH, HEIGHT))
    facets = boundary_facets(mesh.cells)
    top = facets[(mesh.points[facets][:, :, 2] == HEIGHT).all(axis=1)]
    return replace(mesh, surfaces=mesh.surfaces | {"contact": top})


def pads(*middles, half_length=HALF):
    """Faces that press the top of the beam downwards over all its width."""
    count = len(middles)
    centre = np.array([(middle, 0.5 * WIDTH, HEIGHT) for middle in middles])
    ones = np.ones(count)
    return Faces(
        centre,
        np.full(count, 2),
        -ones,
        half_length * ones,
        0.5 * WIDTH * ones,
        0.0 * ones,
        HEIGHT * ones,
        np.arange(count),
        np.arange(count),
    )


def elastic(modulus=MODULUS, poisson_ratio=0.0):
    """At a Poisson ratio of zero the clamp of a solid is that of beam theory."""
    return MaterialTable.model_validate(
        {"density": 1.0, "youngs_modulus": modulus, "poisson_ratio": poisson_ratio},
        context={"bare_numbers_are_si": True},
    )


def beam_theory(first, second):
    """Matrix (2,2) of the patterns 1 and xi between patches with these middles, by the deflection
    x^2 (3 s - x) / 6 E I + x / kappa G A at x <= s under a unit force at s."""
    xi = (np.arange(400) + 0.5) / 200.0 - 1.0
    x, s = (middle + HALF * xi for middle in (first, second))
    near, far = np.minimum(x[:, None], s), np.maximum(x[:, None], s)
    bending, shear = elasticity.cantilever_deflection(1.0, LENGTH, WIDTH, HEIGHT, MODULUS, 0.0)
    deflection = bending * near**2 * (3.0 * far - near) / (2.0 * LENGTH**3) + shear * near / LENGTH
    phi = np.stack([np.ones(xi.size), xi]) / xi.size
    return phi @ deflection @ phi.T


@pytest.mark.case("O6")
def test_beam_under_two_pads():
    """Means and slopes of the deflection under either pad, wherever the pads are on the mesh."""
    rear, front, travel = 0.20, 0.45, (0.0, 0.05, 0.0973)
    found = compliance.of_rails(
        distinct(beam(), elastic()), pads(rear, front), (0.0, LENGTH), travel, patterns=2
    ).matrix
    for moved, matrix in zip(travel, found):
        places = [rear + moved, front + moved]
        for i, j in ((0, 0), (0, 1), (1, 1)):
            exact = beam_theory(places[i], places[j])
            # under its own pressure a slope has a local part, which beam theory does not have
            here = (1, 1) if i == j else (2, 2)
            assert matrix[i, :, j][: here[0], : here[1]] == pytest.approx(
                exact[: here[0], : here[1]], rel=0.01
            )
    # Control: in the place of a point force at the middle the mean under a pad near the root would
    # be off.
    assert (
        abs(
            beam_theory(0.06, 0.06)[0, 0]
            / (elasticity.cantilever_deflection(1.0, 0.06, WIDTH, HEIGHT, MODULUS, 0.0)[0])
            - 1.0
        )
        > 0.01
    )


def test_a_pad_over_the_end_presses_the_part_that_has_a_wall():
    """As a shorter pad there, with its place on the whole one. Past the end it is the last half of
    its length of the rail. Control: the whole pad at its last place has another compliance."""
    travel = np.array([-0.25, 0.0, 0.5, 1.0]) * 2.0 * HALF  # 75, 50, 0 % of the pad have a wall
    over = compliance.of_rails(
        distinct(beam(), elastic()), pads(LENGTH), (0.0, LENGTH), travel, patterns=2
    )

    def shorter(middle, half):
        rails, faces = distinct(beam(), elastic()), pads(LENGTH + middle * HALF, half_length=half)
        return compliance.of_rails(rails, faces, (0.0, LENGTH), (0.0,), patterns=2).matrix[0]

    assert over.part[:, 0] == pytest.approx(
        np.array([[-0.25, 0.75], [-0.5, 0.5], [-1.5, 0.5], [-2.0, 0.5]])
    )
    for matrix, half in zip(over.matrix, (0.75, 0.5, 0.5, 0.5)):
        assert matrix == pytest.approx(shorter(-half, half * HALF), rel=1e-9)
    assert shorter(-1.0, HALF)[0, 0, 0, 0] < 0.95 * over.matrix[1, 0, 0, 0, 0]


def test_half_a_wall_is_pressed_at_its_place():
    """A wall that ends under the middle of a pad has the compliance under the half of the pad over
    it."""
    wall = (0.0, LENGTH + HALF)  # as if a wall went on where the beam ends
    half = compliance.of_rails(distinct(beam(), elastic()), pads(LENGTH), wall, (0.0,), patterns=1)
    short = compliance.of_rails(
        distinct(beam(), elastic()),
        pads(LENGTH - 0.5 * HALF, half_length=0.5 * HALF),
        wall,
        (0.0,),
        patterns=1,
    )
    assert half.gram[0, 0] == pytest.approx(0.5, rel=1e-9)
    # 16 points along an element against 8
    assert 4.0 * half.matrix[0] == pytest.approx(short.matrix[0], rel=1e-3)


def test_compliance_falls_with_the_modulus():
    soft, hard = (
        compliance.of_rails(
            distinct(beam((10, 1, 2)), elastic(modulus, 0.33)), pads(0.3), (0.0, LENGTH), (0.0,)
        ).matrix
        for modulus in (MODULUS, 1024.0 * MODULUS)
    )
    assert 1024.0 * hard == pytest.approx(soft, rel=1e-12)


def test_faults():
    with pytest.raises(ValueError, match="patterns: given 22, expected 1 to 21"):
        compliance.of_rails(
            distinct(beam((10, 1, 2)), elastic()), pads(0.3), (0.0, LENGTH), (0.0,), patterns=22
        )
    loose = beam((10, 1, 2))
    loose.surfaces["mount"] = loose.surfaces["mount"][:0]
    with pytest.raises(MeshError, match="no mount"):
        compliance.of_rails(distinct(loose, elastic()), pads(0.3), (0.0, LENGTH), (0.0,))


def test_loads_have_the_force_and_moment_of_their_pressure():
    """On facets that the face cuts anyhow and that are no rectangles: integrals of phi and phi x, y
    over [-1, 1]^2 by four."""
    mesh = beam((40, 5, 1))
    random = np.random.default_rng(3)
    points = mesh.points.copy()
    inner = (points[:, :2] > 0.0).all(axis=1) & (points[:, 0] < LENGTH) & (points[:, 1] < WIDTH)
    points[inner, :2] += 0.002 * random.uniform(-1.0, 1.0, (inner.sum(), 2))
    middle, half = np.array([0.3071, 0.0143]), np.array([0.0307, -0.0121])
    found = pressure.Wall(points, mesh.surfaces["contact"], 1).pressed(middle, half, 6)
    assert found.gram[0, 0] == pytest.approx(1.0, rel=1e-12)
    local = (points[found.node, :2] - middle) / half
    assert found.load.sum(axis=1) == pytest.approx(
        [1.0, 0.0, 0.0, 1.0 / 3.0, 0.0, 1.0 / 3.0], abs=2e-3
    )
    assert found.load[:3] @ local == pytest.approx(
        np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]) / 3.0, abs=2e-3
    )


def test_a_place_needs_only_the_facets_near_it():
    """The load is that of a short piece of the wall. Control: a piece that ends under the face has
    less load."""
    mesh = beam((40, 5, 1))
    facets = mesh.surfaces["contact"]
    x = mesh.points[facets][:, :, 0]
    middle, half = np.array([0.3071, 0.0143]), np.array([0.0307, 0.0121])
    whole = pressure.Wall(mesh.points, facets, 1).pressed(middle, half, 6)

    def on(first, last):
        piece = facets[(x.min(axis=1) > first) & (x.max(axis=1) < last)]
        return pressure.Wall(mesh.points, piece, 1).pressed(middle, half, 6)

    near = on(0.25, 0.36)
    assert np.array_equal(near.node, whole.node) and np.array_equal(near.load, whole.load)
    assert on(0.29, 0.36).gram[0, 0] < 0.9 < whole.gram[0, 0]


@pytest.mark.parametrize("half", [(0.0307, 0.0121), (0.0307, -0.0121), (0.002, 0.001), (0.5, 0.5)])
def test_a_grid_of_facets_has_the_loads_of_its_facets(half):
    """On a grid the integrals over a face are products; facet by facet they are the same. Facets in
    another order, and a wall that is shorter than the face. Control: walls that are no grid are found."""
    mesh = beam((40, 5, 1))
    facets = mesh.surfaces["contact"]
    facets = facets[np.random.default_rng(1).permutation(len(facets))]
    middle, half = np.array([0.3071, 0.0143]), np.array(half)
    wall = pressure.Wall(mesh.points, facets, 1)
    plane = mesh.points[facets][:, :, :2]
    grid = wall_grid.from_facets(facets, plane)
    assert [line.size for line in grid.lines] == [41, 6]
    found, alone = wall.pressed(middle, half, 21), wall.facet_by_facet(middle, half, 21)
    assert np.array_equal(found.gram, found.gram.T) and found.gram.shape == (21, 21)
    assert found.gram == pytest.approx(alone.gram, rel=1e-12, abs=1e-15)
    loads = np.zeros((2, 21, len(mesh.points)))
    for load, each in zip(loads, (found, alone)):
        assert (np.diff(each.node) > 0).all()
        load[:, each.node] = each.load
    assert loads[0] == pytest.approx(loads[1], rel=1e-12, abs=1e-15)
    moved = plane.copy()
    moved[facets == facets[50, 0]] += (0.0, 1e-6)
    apart = facets.copy()
    apart[50, 0] += 1  # another node at one corner
    for other, at in ((facets, moved), (facets[1:], plane[1:]), (apart, plane)):
        assert wall_grid.from_facets(other, at) is None
    twice = np.concatenate([facets[1:], facets[1:2]])
    assert wall_grid.from_facets(twice, mesh.points[twice][:, :, :2]) is None


@pytest.fixture(scope="module")
def reference():
    return compliance.along(scenes.load("clamped"), 0.004, TRAVEL, patterns=3)


def direct_and_cross(found):
    """Mean compliance of the first rear pad's two walls and between them, (s,) each."""
    return found.matrix[:, 0, 0, 0, 0], found.matrix[:, 1, 0, 1, 0], found.matrix[:, 0, 0, 1, 0]


def test_reciprocity_and_positive_definiteness(reference):
    for matrix in reference.matrix:
        square = matrix.reshape(2 * (matrix.shape[0] * matrix.shape[1],))
        assert np.abs(square - square.T).max() < 1e-9 * np.abs(square).max()
        # rear pads: a front pad at the end of its way may stand where a rear one does
        held = np.r_[0 : 8 * matrix.shape[1]]
        assert np.linalg.eigvalsh(square[np.ix_(held, held)])[0] > 0.0
    assert reference.gram[:, :, 0, 0] == pytest.approx(1.0)
    assert sorted(np.unique(reference.rail, return_counts=True)[1]) == [4, 4, 4, 4]


def test_rail_is_compliant_between_mounts_and_at_its_end(reference):
    first, second, cross = direct_and_cross(reference)
    # the section is the same on both sides of its corner
    assert first == pytest.approx(second, rel=1e-6)
    assert (cross < 0.0).all()  # pressing one leg pulls the other inwards
    assert 1.5 * first[0] < first[2] < first[1] / 1.5  # the last mount ends 8 mm before the rail


def test_mirrored_rails_share_one_solution(monkeypatch):
    scene = scenes.load("clamped")
    mesh = make_mesh(scene, 0.008)
    assert [len(images) for _, images in pieces.distinct(mesh)] == [4]
    assert sum(len(piece.cells) for piece in pieces.pieces(mesh)) == len(mesh.cells)
    once = compliance.along(scene, 0.008, (0.0, 0.03), patterns=3).matrix
    monkeypatch.setattr(pieces, "mirror", lambda *_: None)
    each = compliance.along(scene, 0.008, (0.0, 0.03), patterns=3).matrix
    assert np.abs(once - each).max() < 1e-9 * np.abs(each).max()
    # rear pads on the other rails; faces of different rails have no effect on each other
    for corner in (2, 4, 6):
        assert once[:, corner : corner + 2, :, corner : corner + 2] == pytest.approx(
            once[:, :2, :, :2], rel=1e-9, abs=1e-15
        )
        assert not once[:, :2, :, corner : corner + 2].any()


def test_compliance_converges_with_the_mesh(reference):
    """The wall of 4 mm is one element thick: elements of 2 mm change the direct compliance by 5 %,
    half as much as those of 4 mm did."""
    coarse, fine = (
        direct_and_cross(compliance.along(scenes.load("clamped"), size, TRAVEL[:2], patterns=1))
        for size in (0.008, 0.002)
    )
    for first, second, third in zip(coarse, direct_and_cross(reference), fine):
        change = np.abs(third - second[:2])
        assert (change < 0.06 * fine[0]).all() and (change < 0.6 * np.abs(second[:2] - first)).all()
