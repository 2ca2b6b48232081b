"""A block on a rough plane, and a bouncing ball: stopping, threshold, acceleration, creep, and an
end to the bounces."""

import math

import numpy as np
import pytest

from tests.exact import contact as collisions
from tests.exact import friction as exact
from tests.lowfi.support import G, numerics, scene
from tipoff import lowfi, scenes
from tipoff.mechanics import ledger
from tipoff.results import unfinished

FEET = [{"position": (x, y, -0.02), "normals": ["-z"]} for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
GROUND = {"law": "linear", "clearance": 0.0, "stiffness": 1e8, "damping": 4e4}
TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-6, 1e-8])


def on_slope(angle: float, speed: float, duration: float, transition: float, tolerance: float):
    """A block of 20 kg with coefficient 0.3 on a plane at ``angle`` (rad), started downhill at
    ``speed`` (m/s)."""
    rough = {
        "static": 0.3,
        "dynamic": 0.3,
        "static_speed": transition,
        "dynamic_speed": 2.0 * transition,
    }
    return lowfi.run(
        scene(
            duration,
            1e-3,
            pads=FEET,
            contact=GROUND,
            friction=rough,
            initial={"velocity": {"x": speed}},
            gravity={"x": G * math.sin(angle), "z": -G * math.cos(angle)},
        ),
        "springs",
        numerics=numerics(tolerance),
    )


@pytest.mark.case("O24")
@TWO_TOLERANCES
def test_stopping_distance_and_time(tolerance):
    """v^2 / (2 mu g) and v / (mu g)."""
    run = on_slope(0.0, 2.0, 0.8, 1e-3, tolerance)
    distance, time = exact.stopping(2.0, 0.3, G)
    assert (distance, time) == pytest.approx((0.679811, 0.679811), abs=1e-6)
    assert run.status == "jammed"
    assert run.position[-1, 0] == pytest.approx(distance, rel=2e-3)
    assert run.time[np.flatnonzero(run.velocity[:, 0] < 1e-3)[0]] == pytest.approx(time, rel=2e-3)
    assert run.checks["friction_power_max"] <= 0.0 and run.checks["energy_error"] <= 1e-6
    rubbed = run.energy[-1, ledger.ENTRIES.index("friction")]
    assert rubbed == pytest.approx(0.5 * 20.0 * 2.0**2, rel=2e-3)
    words = unfinished.advice(scenes.parse(run.scene, bare_numbers_are_si=True), run)
    assert words.startswith("stuck on the rail: 680 of ") and "2 m/s at most" in words
    assert "it had 40 J from its start and lost 40 J to friction" in words


@pytest.mark.case("O25")
@TWO_TOLERANCES
def test_sliding_threshold(tolerance):
    """atan(mu) = 16.6992 deg: a hundredth of a degree below, the block comes to a creep; as much
    above, it runs away."""
    limit, hundredth = exact.threshold(0.3), math.radians(0.01)
    assert math.degrees(limit) == pytest.approx(16.6992, abs=1e-4)
    below = on_slope(limit - hundredth, 2e-4, 1.0, 1e-4, tolerance)
    above = on_slope(limit + hundredth, 2.5e-4, 1.0, 1e-4, tolerance)
    assert below.status == "jammed" and below.velocity[-1, 0] < 1e-4
    assert above.status == "time_limit" and above.velocity[-1, 0] > 1.5e-3
    # Control: frictionless, the block below the threshold would be as fast as the one above.
    assert below.velocity[-1, 0] < 1e-3 * G * math.sin(limit) * below.time[-1]


@pytest.mark.case("O25")
@TWO_TOLERANCES
def test_sliding_acceleration(tolerance):
    """g (sin - mu cos) = 0.589501 m/s2 at 20 deg."""
    expected = exact.sliding_acceleration(math.radians(20.0), 0.3, G)
    assert expected == pytest.approx(0.589501, abs=1e-6)
    run = on_slope(math.radians(20.0), 0.1, 0.5, 1e-3, tolerance)
    half = run.time.size // 2
    found = (run.velocity[-1, 0] - run.velocity[half, 0]) / (run.time[-1] - run.time[half])
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.case("O25")
@TWO_TOLERANCES
def test_creep_of_the_smoothed_law(tolerance):
    """Root of mu (3r - r^3)/2 = tan 15 deg: the law creeps at 0.719707 of its transition speed,
    where true sticking would not."""
    ratio = exact.creep_ratio(math.radians(15.0), 0.3)
    assert ratio == pytest.approx(0.719707, abs=1e-6)
    run = on_slope(math.radians(15.0), 0.0, 0.05, 2e-4, tolerance)
    # a creep is slower than the limit of a jam; it has settled before the jam is found
    assert run.status == "jammed" and run.time[-1] >= 5e-3
    assert run.velocity[-1, 0] == pytest.approx(ratio * 2e-4, rel=1e-4)
    # Control: the straight-line law mu s / v_s would creep at tan(15 deg) / mu of it.
    assert abs(math.tan(math.radians(15.0)) / 0.3 - ratio) > 0.1


@pytest.mark.case("O26")
@TWO_TOLERANCES
def test_bounces_come_to_an_end(tolerance):
    """Rest after sqrt(2h/g)(1+e)/(1-e) and a path of h(1+e^2)/(1-e^2): infinitely many bounces in a
    finite time do not stall."""
    height, e = 0.1, 0.8
    low, high = 0.01, 0.5
    for _ in range(60):  # damping ratio whose restitution is e
        zeta = 0.5 * (low + high)
        low, high = (zeta, high) if collisions.linear_restitution(zeta) > e else (low, zeta)
    stiffness = 2e10
    ground = {
        "law": "linear",
        "clearance": height,
        "stiffness": stiffness,
        "damping": 2.0 * zeta * math.sqrt(stiffness),
    }
    run = lowfi.run(
        scene(
            1.4, 5e-5, mass=1.0, contact=ground, gravity={"z": -G}, initial={"velocity": {"x": 1.0}}
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    expected = collisions.bouncing_ball(height, e, G, 11)
    assert tuple(expected.values()) == pytest.approx((1.285278, 0.455556, 1.162607), abs=1e-6)
    assert run.status == "time_limit" and run.time[-1] == pytest.approx(1.4)
    speed = run.velocity[:, 2]
    assert run.time[np.flatnonzero(abs(speed) > 1e-3)[-1]] == pytest.approx(
        expected["rest"], rel=1e-3
    )
    assert abs(np.diff(run.position[:, 2])).sum() == pytest.approx(expected["path"], rel=1e-3)
    bounces = np.flatnonzero((speed[:-1] < 0.0) & (speed[1:] > 0.0))
    assert run.time[bounces[10]] == pytest.approx(expected["contact"], rel=1e-3)
    # Control: explicit Euler at the sampling step does not lose energy at the wall, it is thrown
    # back faster than it came.
    thrown = collisions.explicit_euler_restitution(
        lambda p, q: max(0.0, stiffness * p + ground["damping"] * q), 1.0, 1.4, 5e-5
    )
    assert thrown > 1.0
