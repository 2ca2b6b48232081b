"""Joints under the mounts in the full time loop: a block on springs, what they do to the platform,
ledgers, bits, code, and the run of a tetrahedral mesh."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from tests.highfi.blocks import block
from tests.highfi.dynamics import test_elastic as test_kernels
from tests.highfi.dynamics.test_damping import scene
from tests.highfi.support import COARSE, assert_same_bits, begun, loop_on, tiny
from tests.highfi.tets import split
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics import mounts, observe
from tipoff.highfi.dynamics.checkpoint import Checkpoint, restore
from tipoff.highfi.statics import assembly, stable_step
from tipoff.highfi.statics import mounts as statics
from tipoff.mechanics.laws.mount_stiffness import MountStiffness

SIDE, DENSITY, MODULUS = 0.02, 2810.0, 72e9
# The block is stiffer than its springs by E / (k l) = 3.6e5.
JOINT = {"normal": 1e7, "shear": 4e6}
SOFT = {"rail__mount_stiffness__normal": "1e13 N/m^3", "rail__mount_stiffness__shear": "5e12 N/m^3"}
DAMPED = {"rail__damping__frequencies": ["500 Hz", "5 kHz"], "rail__damping__ratios": [0.05, 0.01]}
EARLY = {"duration": "9 ms", "contact__clearance": "0.05 mm"}
PLATFORM = {"mass": 0.2, "inertia": {"xx": 1e-3, "yy": 1e-3, "zz": 1e-3}}


def cube(tetrahedra=False):
    """A cube on the springs under its face x = 0, its middle on the X axis."""
    mesh = block((2, 2, 2), (SIDE, SIDE, SIDE))
    mesh.points[:, 1:] -= 0.5 * SIDE
    mesh.surfaces["contact_y"] = mesh.surfaces["mount"]
    return split(mesh) if tetrahedra else mesh


def on_springs(platform=None, joint=JOINT, **tables):
    rail = {
        "start": 0.0,
        "end": SIDE,
        "material": {"density": DENSITY, "youngs_modulus": MODULUS, "poisson_ratio": 0.33},
        "mount_stiffness": joint,
    }
    return scene(rail=rail, platform=platform, **tables)


def released(loop, axis, count=60, amplitude=1e-6):
    """Displacement (count,) m of the mass centre along ``axis``, let go from rest, at each sample,
    and the samples themselves."""
    number, mass = loop.setup.system.number, loop.setup.system.operator.mass
    loop.stepper.state.displacement[number, axis] = amplitude
    loop.begin()
    found = [amplitude]
    while len(found) < count:
        loop.advance_one_sample()
        found.append(float(mass @ loop.stepper.state.displacement[number, axis]) / mass.sum())
        assert not loop.recorded.message
    return np.array(found), np.array(loop.recorded.rows)


class Places(NamedTuple):
    points: np.ndarray


@pytest.mark.parametrize("angle, mixed", [(0.0, 0), (0.3, 49)])
def test_strips_across_an_axis_and_oblique_ones_have_the_force_of_their_matrix(angle, mixed):
    """S u, its moments and sums from the matrix of the joints of a strip turned about Y; all 49
    pairs of the 9 nodes of a strip of four facets are neighbours of each other."""
    mesh = cube()
    cosine, sine = math.cos(angle), math.sin(angle)
    points = mesh.points @ np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    matrix = statics.stiffness(points, mesh.surfaces["mount"], MountStiffness(3e9, 1e9))
    number = np.random.default_rng(1).permutation(len(points))
    record = mounts.build(matrix, number, np.array([0, len(points)]))
    assert len(record.mixed_stiffness) == mixed
    places, u, force = (np.zeros(points.shape, order="F") for _ in range(3))
    places[number], u[number] = points, np.random.default_rng(2).normal(0.0, 1e-6, points.shape)
    turn, total = np.ones(3), np.ones((1, 6))
    mounts.add_mounts(record, Places(places), u, force, 0, turn, total)
    exact = (matrix @ u[number].ravel()).reshape(-1, 3)
    size = np.abs(exact).max()
    assert np.abs(force[number] - exact).max() <= 1e-14 * size
    turned, moved = np.cross(u[number], exact).sum(axis=0), np.cross(points, exact).sum(axis=0)
    assert np.abs(turn - 1.0 - turned).max() <= 1e-14
    sums = np.concatenate([exact.sum(axis=0), moved])
    assert np.abs(total[0] - sums).max() <= 1e-13 * size


@pytest.mark.case("O54")
@pytest.mark.parametrize(
    "platform, tetrahedra",
    [
        (PLATFORM, False),
        pytest.param(PLATFORM, True, marks=pytest.mark.slow),
        pytest.param(None, False, marks=pytest.mark.slow),
        pytest.param(None, True, marks=pytest.mark.slow),
    ],
)
def test_a_block_on_springs_swings_with_the_root_of_stiffness_over_mass(platform, tetrahedra):
    """cos(w t) with w^2 = k A / m along the normal, m the reduced mass on a free platform of
    0.2 kg. The energy is k A a^2 / 2. Controls: fixed and free platform differ by far more, and
    without the energy of the springs nothing would balance."""
    mass = DENSITY * SIDE**3
    other = PLATFORM["mass"] - mass
    reduced = mass if platform is None else mass * other / PLATFORM["mass"]
    frequency = math.sqrt(JOINT["normal"] * SIDE**2 / reduced)
    interval = 2.0 * math.pi / frequency / 30.0
    given = on_springs(platform, output={"interval": interval})
    loop = loop_on(given, cube(tetrahedra))
    moved, rows = released(loop, 0)
    exact = 1e-6 * np.cos(frequency * interval * np.arange(moved.size))
    assert np.abs(moved - exact).max() < 2e-5 * 1e-6
    fixed = 1e-6 * np.cos(math.sqrt(reduced / mass) * frequency * interval * np.arange(60))
    assert platform is None or np.abs(moved - fixed).max() > 0.3e-6
    strain = 0.5 * JOINT["normal"] * SIDE**2 * 1e-12
    total = rows[:, observe.KINETIC] + rows[:, observe.STRAIN]
    assert total == pytest.approx(strain, rel=1e-5) and np.ptp(total) <= 1e-9 * strain
    assert rows[:, observe.KINETIC].max() > 0.9 * strain


@pytest.mark.case("O54")
@pytest.mark.parametrize(
    "damping",
    [
        None,
        pytest.param(
            {"frequencies": [67.0, 6700.0], "ratios": [0.05, 0.01]}, marks=pytest.mark.slow
        ),
    ],
)
def test_the_platform_takes_the_opposite_of_what_the_springs_give(damping):
    """A block that is let go across the rail turns and moves a free platform: linear and angular
    momentum of both stay zero, damped or not, but for the rounding of the block's own forces.
    Control: without what the springs do to the platform, all that it has would be missing."""
    given = on_springs(PLATFORM, output={"interval": 1e-4})
    if damping:
        given = given.replace({f"rail.damping.{key}": value for key, value in damping.items()})
    loop = loop_on(given, cube())
    momentum = []
    for axis in (1, 2):
        loop.stepper.state.displacement[loop.setup.system.number, axis] = 1e-6
    loop.begin()
    for _ in range(60):
        loop.advance_one_sample()
        body = loop.stepper.state.platform
        momentum.append([*loop.setup.system.frame.mass * body.velocity, *body.spin])
    rows, largest = np.array(loop.recorded.rows), np.abs(momentum).max(axis=0)
    linear = np.abs(rows[:, observe.LINEAR : observe.LINEAR + 3]).max()
    angular = np.abs(rows[:, observe.ANGULAR : observe.ANGULAR + 3]).max()
    assert largest[1:3].min() > 1e-6 and linear <= 1e-8 * largest[1:3].max()
    assert largest[4:6].min() > 1e-9 and angular <= 1e-8 * largest[4:6].max()


@pytest.mark.slow
def test_weight_on_the_springs():
    """A block that hangs on springs, damped by its mass, comes to rest m g / (k A) below where it was let go."""
    given = on_springs(output={"interval": 1e-3}, gravity={"x": 0.0, "y": 0.0, "z": 0.0}).replace(
        {
            "gravity.x": -9.80665,
            "rail.damping.frequencies": [67.0, 670.0],
            "rail.damping.ratios": [0.5, 0.05],
        }
    )
    loop = loop_on(given, cube())
    moved, _ = released(loop, 0, 120, 0.0)
    depth = DENSITY * SIDE * 9.80665 / JOINT["normal"]
    assert moved[-1] == pytest.approx(-depth, rel=1e-4)


@pytest.mark.parametrize("tetrahedra", [False, True])
def test_step_encloses_the_springs(tetrahedra):
    """On springs as stiff as the block the highest frequency lies between 0.999 and 1 of its
    bound, and below that of single elements. Control: the bound of the same block on rigid mounts
    is exceeded."""
    stiff = {"normal": 1e15, "shear": 1e15}
    rigid, soft = (
        loop_on(on_springs(joint=joint), cube(tetrahedra)).setup.system.operator
        for joint in ({"normal": 1.0, "shear": 1.0}, stiff)
    )
    root = np.repeat(soft.mass, 3) ** -0.5
    matrix = assembly.sparse(soft).toarray() * root[:, None] * root
    highest = math.sqrt(np.linalg.eigvalsh(matrix)[-1])
    bound = stable_step.operator_bound(soft).upper
    assert highest <= bound <= highest / 0.999 and bound <= stable_step.element_bound(soft)
    assert highest > 1.5 * stable_step.element_bound(rigid)


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        DAMPED,
        {"platform": None, "gravity__z": "-9.81 m/s**2"},
    ],
)
def test_ledgers_close_and_momenta_are_kept(change):
    """Contact, friction, a free or fixed platform, weight. Control: without the forces of the
    springs on the platform, momentum would change in one sample by far more than it does in all."""
    loop = begun(tiny(**EARLY, **SOFT, **change))
    loop.integrate(None)
    found = loop.trajectory({}, COARSE)
    assert np.abs(found.pad_force).max() > 1.0
    assert found.checks["energy_error"] <= 1e-5 and found.checks["transverse_energy_error"] <= 1e-4
    assert (
        found.checks["linear_momentum_error"] <= 1e-12
        and found.checks["angular_momentum_error"] <= 1e-10
    )
    force, moment = (
        np.linalg.norm(loop.stepper.state.mounting.sum(axis=0).reshape(2, 3), axis=1) * 1e-4
    )
    payload = np.linalg.norm(found.velocity[-1]) * 9.9
    assert force > 1e-9 * payload and moment > 1e-8 * payload * np.linalg.norm(found.position[-1])


@pytest.mark.slow
@pytest.mark.case("X20")
@pytest.mark.parametrize("kernel", ["columns", "elements"])
def test_threads_and_a_resume_do_not_change_a_bit(tmp_path, kernel):
    """One thread makes the whole run; the run that is resumed ends with three."""
    whole, half, second = (
        test_kernels.begun(kernel, "early", threads, **SOFT, **DAMPED) for threads in (1, 1, 3)
    )
    whole.integrate(None)
    expected = whole.trajectory({}, test_kernels.NUMERICS)
    for _ in range(45):
        half.advance_one_sample()
    kept = Checkpoint(tmp_path / "run", 0.0, half, test_kernels.NUMERICS)
    kept.write(half)
    saved = kept.read()
    assert np.abs(saved["state.history.mounting"]).max() > 0.0
    restore(second, saved)
    second.integrate(None)
    result = second.trajectory({}, test_kernels.NUMERICS)
    assert_same_bits(result, expected)


@pytest.mark.slow
def test_columns_and_elements_carry_the_same_run():
    runs = []
    for kernel in ("columns", "elements"):
        loop = test_kernels.begun(kernel, "early", **SOFT)
        loop.integrate(None)
        runs.append(loop.trajectory({}, test_kernels.NUMERICS))
    columns, elements = (run.rate for run in runs)
    assert np.abs(columns - elements).max() <= 1e-9 * np.abs(elements).max()


@pytest.mark.slow
def test_rigid_mounts_are_the_limit_of_stiff_ones():
    """The rates approach those on rigid mounts with 1 / k. Control: 1e13 N/m3 changes them."""
    step = Numerics(element_size=0.008, step=1e-7)
    rates = [
        highfi.run(
            tiny(**EARLY, rail__mount_stiffness__normal=k, rail__mount_stiffness__shear=0.5 * k)
            if k
            else tiny(**EARLY),
            step,
        ).rate
        for k in (None, 1e15, 1e14, 1e13)
    ]
    little, more, real = (np.abs(rate - rates[0]).max() for rate in rates[1:])
    assert 5.0 < more / little < 20.0 and real > 3.0 * more
