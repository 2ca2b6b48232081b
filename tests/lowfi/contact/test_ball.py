"""A ball that bounces: Hertz's law of impact, and the oblique bounce that slips or rolls."""

import math

import pytest
from scipy.optimize import brentq

from tests.exact import contact as exact
from tests.lowfi import ball
from tests.lowfi.support import close, drop

RADIUS = 0.010
MASS = ball.mass(RADIUS, 7850.0)
TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-7, 1e-9])


@pytest.mark.case("O18")
@TWO_TOLERANCES
def test_hertz_impact(tolerance):
    """Steel ball on aluminium at 0.1 m/s: p = (5 m v^2 / 4 k)^0.4, F = k p^1.5, T = 2.9433 p /
    v."""
    k = exact.hertz_stiffness(RADIUS, (210e9, 0.3), (72e9, 0.33))
    assert (MASS, k) == pytest.approx((32.882e-3, 7.97939e9), rel=1e-6)
    expected = exact.power_law_collision(MASS, 0.1, k, 1.5)
    close(expected, {"penetration": 4.83904e-6, "force": 84.9393, "duration": 142.426e-6}, 3e-6)
    law = {
        "law": "hunt-crossley",
        "clearance": 1e-7,
        "exponent": 1.5,
        "stiffness": k,
        "dissipation": 0.0,
    }
    found, run = drop(law, tolerance, expected["duration"], v=0.1, mass=MASS)
    close(found, expected | {"restitution": 1.0}, 1e-4)
    assert run.checks["energy_error"] <= 1e-6
    # Control: explicit Euler, a hundred steps to the contact, throws the ball back 6 % faster than
    # it came.
    euler = exact.explicit_euler_restitution(
        lambda p, _: k * max(p, 0.0) ** 1.5, MASS, 0.1, expected["duration"] / 100
    )
    assert euler > 1.05


def bounce(vt: float, tolerance: float, mu: float = 0.2, e: float = 0.9) -> tuple[float, float]:
    """Speed (m/s) along the wall and spin (rad/s) after a bounce at 1 m/s. It is stiff: the ball
    hardly turns meanwhile."""
    stiffness, gap = 1e9, 1e-6
    zeta = brentq(lambda z: exact.linear_restitution(z) - e, 1e-3, 0.5)
    run = ball.strike(
        RADIUS,
        MASS,
        (vt, 1.0),
        contact={
            "law": "linear",
            "clearance": gap,
            "stiffness": stiffness,
            "damping": 2.0 * zeta * math.sqrt(stiffness * MASS),
        },
        friction={"static": mu, "dynamic": mu, "static_speed": 1e-4, "dynamic_speed": 2e-4},
        duration=gap + 2.0 * math.pi * math.sqrt(MASS / stiffness),
        tolerance=tolerance,
    )
    assert run.checks["friction_power_max"] <= 0.0
    assert run.velocity[-1, 2] == pytest.approx(e, rel=5e-3)
    return run.velocity[-1, 0], run.rate[-1, 1]


@pytest.mark.case("O33")
@TWO_TOLERANCES
def test_oblique_bounce_in_gross_slip(tolerance):
    """vt - mu (1 + e) vn = 2.120 m/s and 2.5 mu (1 + e) vn / R = 95.0 rad/s."""
    expected = exact.oblique_ball(1.0, 2.5, 0.2, 0.9, RADIUS)
    assert expected == pytest.approx((2.120, 95.0), rel=1e-12)
    assert bounce(2.5, tolerance) == pytest.approx(expected, rel=5e-3)


@pytest.mark.case("O33")
@TWO_TOLERANCES
def test_oblique_bounce_on_either_side_of_the_threshold(tolerance):
    """At tan(angle) = 3.5 mu (1 + e), 53.0612 deg, slipping throughout turns into leaving at a
    roll."""
    threshold = 3.5 * 0.2 * 1.9
    assert math.degrees(math.atan(threshold)) == pytest.approx(53.0612, abs=5e-5)
    for vt, slips in ((threshold / 1.005, False), (threshold * 1.005, True), (1.0, False)):
        speed, spin = bounce(vt, tolerance)
        assert (speed, spin) == pytest.approx(
            exact.oblique_ball(1.0, vt, 0.2, 0.9, RADIUS), rel=5e-3
        )
        assert (speed - spin * RADIUS > 1e-3) == slips
    # Control: the formula of gross slip is 13 % off well below the threshold.
    assert abs((1.0 - 0.2 * 1.9) / speed - 1.0) > 0.1
