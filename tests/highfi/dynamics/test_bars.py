"""Waves and impacts in slender bars: the speed of a front, a bar pushed at one end, two rods that
collide.

With nu = 0 a row of hexahedra moves axially like a bar, whatever its width. The rods press on each
other through a penalty of the test's own, because the contact of the product is that of rigid pads;
the bars and the steps are the product's.
"""

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import block
from tests.highfi.leapfrog import driven
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics import stable_step as timestep
from tipoff.highfi.statics.operator import internal_force

LENGTH, WIDTH, MODULUS, DENSITY = 0.5, 0.02, 72e9, 2810.0
AREA = WIDTH**2
SPEED = elasticity.bar_speed(MODULUS, DENSITY)
TWO_STEPS = pytest.mark.parametrize("fraction", [0.9, 0.45])


def stable_step(operator, fraction):
    return fraction * timestep.critical_step(timestep.element_bound(operator))


def at_rest(mesh):
    return np.zeros(mesh.points.shape), np.zeros(mesh.points.shape)


def end_load(mesh, station, force):
    """Axial force (N) shared by the nodes of one end section."""
    end = mesh.points[:, 0] == station
    load = np.zeros(mesh.points.shape)
    load[end, 0] = force / end.sum()
    return load


def arrival(elements, width, poisson_ratio, speed, fraction):
    """Time (s) at which a front of stress 1 MPa, started at one free end, brings the other to half
    of the speed it settles at."""
    mesh = block((elements, 1, 1), (LENGTH, width, width))
    operator = assembly.build(mesh, DENSITY, MODULUS, poisson_ratio, fixed=())
    step = stable_step(operator, fraction)
    load, (displacement, velocity) = end_load(mesh, 0.0, 1e6 * width**2), at_rest(mesh)
    far, half, before = mesh.points[:, 0] == LENGTH, 1e6 / (DENSITY * speed), 0.0
    for time in driven(operator, step, lambda *_: load, displacement, velocity):
        now = velocity[far, 0].mean()
        if now >= half:
            return time - 0.5 * step - (now - half) / (now - before) * step
        before = now


@pytest.mark.case("O1")
@TWO_STEPS
def test_front_in_a_bar(fraction):
    """c = sqrt(E / rho) = 5061.89 m/s: the front takes 98.777 us over 0.5 m."""
    exact = LENGTH / SPEED
    assert (SPEED, exact) == pytest.approx((5061.89, 98.777e-6), rel=5e-6)
    assert arrival(100, LENGTH / 100, 0.0, SPEED, fraction) == pytest.approx(exact, rel=0.01)
    # Control: a quarter of the elements smears the front too much.
    assert arrival(25, LENGTH / 25, 0.0, SPEED, fraction) > 1.01 * exact


@pytest.mark.case("O1")
@TWO_STEPS
def test_front_in_a_confined_column(fraction):
    """sqrt((lambda + 2 G) / rho) = 6161.48 m/s, where the column's own width keeps it from
    expanding while the front passes."""
    speed = elasticity.confined_speed(MODULUS, 0.33, DENSITY)
    assert speed == pytest.approx(6161.48, rel=2e-6)
    assert arrival(100, 1e3 * LENGTH / 100, 0.33, speed, fraction) == pytest.approx(
        LENGTH / speed, rel=0.01
    )


@pytest.mark.case("O5")
@TWO_STEPS
@pytest.mark.parametrize("elements", [100, 200])
def test_free_bar_pushed_at_one_end(elements, fraction):
    """The pushed end moves at 0.175760, 0.527281, 0.878801 m/s in turn, the bar shortens in a
    triangle wave up to 17.361 um, and its mass centre accelerates at F / m = 1779.36 m/s2."""
    force, window = 1000.0, 2.0 * LENGTH / SPEED
    mesh = block((elements, 1, 1), (LENGTH, WIDTH, WIDTH))
    operator = assembly.build(mesh, DENSITY, MODULUS, 0.0, fixed=())
    step = stable_step(operator, fraction)
    load, (displacement, velocity) = end_load(mesh, 0.0, force), at_rest(mesh)
    near, far = mesh.points[:, 0] == 0.0, mesh.points[:, 0] == LENGTH
    rows = []
    for time in driven(operator, step, lambda *_: load, displacement, velocity):
        if time > 3.0 * window:
            break
        rows.append(
            (
                time - 0.5 * step,
                velocity[near, 0].mean(),
                operator.mass @ velocity[:, 0] / operator.mass.sum(),
                displacement[near, 0].mean() - displacement[far, 0].mean(),
            )
        )
    time, pushed, centre, shortening = np.array(rows).T
    exact = [elasticity.pushed_bar(number, force, AREA, MODULUS, DENSITY) for number in (1, 2, 3)]
    assert exact == pytest.approx([0.175760, 0.527281, 0.878801], abs=1e-6)
    assert [pushed[time // window == number].mean() for number in (0, 1, 2)] == pytest.approx(
        exact, rel=0.01
    )
    acceleration = force / (DENSITY * AREA * LENGTH)
    assert acceleration == pytest.approx(1779.36, abs=0.005)
    assert np.abs(centre / time / acceleration - 1.0).max() < 1e-10
    largest = elasticity.largest_shortening(force, LENGTH, AREA, MODULUS)
    assert largest == pytest.approx(17.361e-6, abs=5e-10)
    assert shortening.max() == pytest.approx(largest, rel=0.01)
    assert shortening.mean() == pytest.approx(0.5 * largest, rel=0.01)


def two_rods(elements):
    """Two equal rods in a row that share no node."""
    rod = block((elements, 1, 1), (LENGTH, WIDTH, WIDTH))
    return RailMesh(
        np.concatenate([rod.points, rod.points + np.array([LENGTH, 0.0, 0.0])]),
        np.concatenate([rod.cells, rod.cells + len(rod.points)]),
        {},
    )


def collide(elements, fraction, stiffness, speed=2.0):
    """Throw the first rod at the second; a corner pair carries `stiffness` times E A / 4 h for each
    m of overlap.

    Returns the impulse (N s), twice the time of the force's centroid (s), mean speeds (m/s)
    afterwards, and the relative changes of momentum and energy.
    """
    mesh = two_rods(elements)
    operator = assembly.build(mesh, DENSITY, MODULUS, 0.0, fixed=())
    half = len(mesh.points) // 2
    left, right = (
        np.flatnonzero(mesh.points[part, 0] == LENGTH) + part.start
        for part in (slice(0, half), slice(half, None))
    )
    penalty = stiffness * MODULUS * AREA * elements / LENGTH / 4
    # What a spring between two masses adds to the squared frequency, on top of the element bound.
    highest = (
        timestep.element_bound(operator) ** 2
        + penalty * (1.0 / operator.mass[left] + 1.0 / operator.mass[right]).max()
    )
    step = fraction * timestep.critical_step(np.sqrt(highest))
    displacement, velocity = at_rest(mesh)
    velocity[:half, 0] = speed
    start = operator.mass @ velocity
    forces, drift = [], 0.0

    def contact(_, u):
        push = penalty * np.maximum(u[left, 0] - u[right, 0], 0.0)
        load = np.zeros_like(u)
        load[left, 0], load[right, 0] = -push, push
        forces.append(push.sum())
        return load

    for time in driven(operator, step, contact, displacement, velocity):
        drift = max(drift, np.abs(operator.mass @ velocity - start).max())
        if time > 3.0 * LENGTH / SPEED:
            break
    assert forces[-1] == 0.0
    force, time = np.array(forces), step * np.arange(len(forces))
    # The kinetic energy at the time of the displacement, from the half steps around it: the one the
    # scheme keeps.
    strained = np.empty_like(displacement)
    internal_force(displacement, operator.cells, operator.shape_class, operator.stiffness, strained)
    following = velocity - step * strained / operator.mass[:, None]
    energy = 0.5 * (
        operator.mass @ (velocity * following).sum(axis=1) + (displacement * strained).sum()
    )
    rod = operator.mass[:half] / operator.mass[:half].sum()
    return {
        "impulse": step * force.sum(),
        "duration": 2.0 * (force @ time) / force.sum(),
        "first": rod @ velocity[:half, 0],
        "second": rod @ velocity[half:, 0],
        "momentum": drift / start[0],
        "energy": energy / (0.5 * start[0] * speed) - 1.0,
    }


@pytest.mark.case("O3")
@TWO_STEPS
@pytest.mark.parametrize("elements", [100, 200])
def test_equal_rods_swap_their_speeds(elements, fraction):
    """2 L / c = 197.554 us, rho c v / 2 = 14.2239 MPa or 5689.57 N, then 0 and 2 m/s."""
    exact = elasticity.rod_impact(LENGTH, AREA, 2.0, MODULUS, DENSITY)
    assert list(exact.values())[:3] == pytest.approx([197.554e-6, 14.2239e6, 5689.57], rel=5e-6)
    found = collide(elements, fraction, 1.0)
    assert found["impulse"] == pytest.approx(exact["impulse"], rel=0.01)
    assert found["duration"] == pytest.approx(exact["duration"], rel=0.02)
    assert abs(found["first"]) <= 0.02 and abs(found["second"] - 2.0) <= 0.02
    assert found["momentum"] <= 1e-12
    assert abs(found["energy"]) <= 1e-3


@pytest.mark.case("O3")
def test_wrong_penalties_are_seen():
    """Controls: with a soft penalty the collision lasts too long. A penalty that is too stiff for
    the mesh is below the limit of linear stability, yet creates energy at each switch of
    contact; at nine tenths of the limit it creates much."""
    soft, stiff = collide(100, 0.9, 0.1), collide(100, 0.9, 3.0)
    assert soft["duration"] > 1.02 * 2.0 * LENGTH / SPEED
    assert stiff["energy"] > 0.1
