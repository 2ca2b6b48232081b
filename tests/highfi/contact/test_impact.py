"""Impacts through the product's own contact, in the full time loop: a rod on a rigid wall, a rigid
body on a linear pad.

The wall is a pad face of a payload so heavy that it does not slow down; the rod is a rail that
nothing holds.
"""

import numpy as np
import pytest

from tests.exact import contact, elasticity
from tests.highfi.blocks import block
from tests.highfi.support import NEUTRAL, last_sample, loop_on
from tipoff.highfi.dynamics import observe
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.numerics import Numerics
from tipoff.scenes import parse

MODULUS, DENSITY, WIDTH, GAP = 72e9, 2810.0, 0.02, 1e-6
LENGTH, AREA = 0.3, WIDTH**2
WALL = 1e6  # kg
INTERVAL = 5e-7  # s
TWO_STEPS = pytest.mark.parametrize("safety", [0.9, 0.45])


def scene(mass, speed, interface_stiffness, duration, interval):
    """A payload whose one flat face moves along +y at a surface in the plane y = 0, GAP away and
    wider than it."""
    return parse(
        NEUTRAL
        | {
            "name": "impact",
            "duration": duration,
            "output": {"interval": interval},
            "pads": [
                {
                    "position": [0.0, -GAP, 0.0],
                    "normals": ["+y"],
                    "length": 2.0 * WIDTH,
                    "width": 2.0 * WIDTH,
                }
            ],
            "payload": {"mass": mass, "inertia": {"xx": mass, "yy": mass, "zz": mass}},
            "rail": {
                "start": -0.5 * WIDTH,
                "end": 0.5 * WIDTH,
                "material": {"density": DENSITY, "youngs_modulus": MODULUS, "poisson_ratio": 0.0},
            },
            "contact": {
                "law": "linear",
                "clearance": GAP,
                "stiffness": 1.0,
                "interface_stiffness": interface_stiffness,
            },
            "initial": {"velocity": {"y": speed}},
        },
        bare_numbers_are_si=True,
    )


def rail(elements, length, clamped):
    """Square bar along y in the path of the payload's mass centre: its face y = 0 is touched; all
    facets are clamped or none."""
    mesh = block((2, elements, 1), (WIDTH, length, WIDTH))
    facets = boundary_facets(mesh.cells)
    touched = facets[(mesh.points[facets][:, :, 1] == 0.0).all(axis=1)]
    centred = mesh.points - [0.5 * WIDTH, 0.0, 0.5 * WIDTH]
    return RailMesh(
        centred, mesh.cells, {"contact_y": touched, "mount": facets if clamped else facets[:0]}
    )


def integrate(loop):
    """Samples until the scene's duration: rows, and the force (N) on the payload along y."""
    loop.begin()
    for _ in range(last_sample(loop)):
        loop.advance_one_sample()
    assert not loop.recorded.message
    return np.array(loop.recorded.rows), np.array(loop.recorded.forces)[:, 0, 1]


def strike(elements, stiffness, safety=0.9, speed=3.0):
    """Drive the wall into a rod of `elements`; the interface stiffness is `stiffness` times that of
    an element, E / h.

    Returns the impulse (N s), twice the time of the force's centroid since first touch (s), and
    restitution.
    """
    interface_stiffness = stiffness * MODULUS * elements / LENGTH
    rod, numerics = rail(elements, LENGTH, clamped=False), Numerics(safety=safety)
    rows, force = integrate(
        loop_on(scene(WALL, speed, interface_stiffness, 150e-6, INTERVAL), rod, numerics)
    )
    assert force[-1] == 0.0
    time = INTERVAL * np.arange(force.size) - GAP / speed
    impulse = rows[-1, observe.LINEAR + 1] - WALL * rows[-1, observe.VELOCITY + 1]
    return {
        "impulse": impulse,
        "duration": 2.0 * (force @ time) / force.sum(),
        "restitution": impulse / (DENSITY * AREA * LENGTH * speed) - 1.0,
    }


# A rod that meets a wall at v does what one that meets an equal rod at 2 v does.
EXACT = elasticity.rod_impact(LENGTH, AREA, 6.0, MODULUS, DENSITY)


@pytest.mark.case("O4")
@TWO_STEPS
@pytest.mark.parametrize("elements", [60, pytest.param(120, marks=pytest.mark.slow)])
def test_rod_strikes_a_wall(elements, safety):
    """2 L / c = 118.533 us, rho c v = 42.672 MPa, impulse 2 m v = 2.0232 N s, e = 1."""
    assert (EXACT["duration"], EXACT["stress"], EXACT["impulse"]) == pytest.approx(
        (118.533e-6, 42.672e6, 2.0232), rel=1e-5
    )
    found = strike(elements, 1.0, safety)
    assert found["impulse"] == pytest.approx(EXACT["impulse"], rel=0.01)
    assert found["duration"] == pytest.approx(EXACT["duration"], rel=0.02)
    # An impulse within 1 % is a restitution within 2 %.
    assert found["restitution"] == pytest.approx(1.0, abs=0.02)
    # Control: a tenth of the interface stiffness lets the rod dwell too long.
    assert strike(elements, 0.1, safety)["duration"] > 1.02 * EXACT["duration"]


@pytest.mark.case("O31")
@pytest.mark.parametrize("safety", [0.9, pytest.param(0.45, marks=pytest.mark.slow)])
def test_rod_converges_with_the_interface_stiffness(safety):
    """With the interface stiffness at a fixed share of E / h both are refined together; the
    duration's error falls faster than k^-1/2."""
    errors = np.array(
        [
            strike(elements, 0.3, safety)["duration"] / EXACT["duration"] - 1.0
            for elements in (60, 120, 240)
        ]
    )
    assert (np.log2(errors[1:] / errors[:-1]) <= -0.4).all()
    # Control: on the coarsest mesh this interface stiffness fails O4, so there is something to
    # converge from.
    assert errors[0] > 0.02


@pytest.mark.case("O31")
@pytest.mark.parametrize(
    "stiffness, answer, safety",
    [
        (7e7, 1.679252e-3, 0.9),
        (2.8e8, 0.839626e-3, 0.45),
        pytest.param(7e7, 1.679252e-3, 0.45, marks=pytest.mark.slow),
        pytest.param(2.8e8, 0.839626e-3, 0.9, marks=pytest.mark.slow),
    ],
)
def test_body_bounces_off_a_linear_pad(stiffness, answer, safety):
    """20 kg on a clamped surface: T = pi sqrt(m / k), and at every sample p = N / k."""
    mass, speed, interface_stiffness = 20.0, 0.05, stiffness / AREA
    expected = contact.power_law_collision(mass, speed, stiffness, 1.0)
    assert expected["duration"] == pytest.approx(answer, rel=1e-6)
    flight = GAP / speed + 1.2 * answer
    interval = flight / 1000
    ground, numerics = rail(1, WIDTH, clamped=True), Numerics(safety=safety)
    rows, force = integrate(
        loop_on(scene(mass, speed, interface_stiffness, flight, interval), ground, numerics)
    )
    place, velocity = rows[:, observe.POSITION + 1] - GAP, rows[-1, observe.VELOCITY + 1]
    # It flies straight before and after, so both ends of the contact are known exactly.
    duration = interval * (len(rows) - 1) - place[-1] / velocity - GAP / speed
    assert duration == pytest.approx(answer, rel=1e-4)
    assert velocity == pytest.approx(-speed, rel=1e-4)
    assert place.max() == pytest.approx(expected["penetration"], rel=1e-4)
    pressed = force < 0.0
    assert pressed.any() and force[pressed] == pytest.approx(-stiffness * place[pressed], rel=1e-9)
