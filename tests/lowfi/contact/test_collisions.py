"""One body against one pad: restitution, penetration, force and duration against closed forms, at
two tolerances."""

import math

import numpy as np
import pytest

from tests.exact import contact as exact
from tests.lowfi.support import PAPER_PAD, G, close, drop, numerics, scene
from tipoff import lowfi
from tipoff.lowfi import state, system
from tipoff.lowfi.contact import springs
from tipoff.lowfi.faces import FACE_SIZE
from tipoff.mechanics.absent import SMOOTH
from tipoff.mechanics.laws import contact as law
from tipoff.scenes import scene_model

K = PAPER_PAD["stiffness"]
TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-7, 1e-9])


@pytest.mark.case("O20")
@pytest.mark.parametrize(
    "p_mm, closing, force",
    [
        (0.05, 0.0, 782.624),
        (0.10, 20.0, 2524.705),
        (0.15, 20.0, 4666.633),
        (0.30, 20.0, 12702.174),
        (0.01, -400.0, 0.0),
    ],
)
def test_impact_spot_values(p_mm, closing, force):
    """F = max(0, k p^e + c s(p/d) p') at the paper's pad, from the load on a face."""
    pressed = system.build(scene_model.build(scene(1e-3, 1e-4, contact=PAPER_PAD)))
    contact = pressed.contact
    turn, zero = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
    body = state.Motion(zero, (0.0, 0.0, -closing / 1e3), turn, zero, zero)
    face = np.zeros(FACE_SIZE)
    face[:7] = 0.0, 0.0, -0.1, 0.0, -1.0, 0.1, 0.0
    found = springs.load(
        contact,
        SMOOTH,
        pressed.platform,
        face,
        p_mm * 1e-3,
        body,
        state.Motion(zero, zero, turn, zero, zero),
    ).normal[2]
    assert found == pytest.approx(
        exact.impact_force(K, 1.5, 60000.0, 3e-4, p_mm * 1e-3, closing / 1e3), rel=1e-9, abs=1e-12
    )
    assert found == pytest.approx(force, abs=5e-4)
    # Controls: without the cut-off the law pulls while the pad opens fast; with its damping there
    # at once, not by the cubic step, it is off where the pad is shallow.
    uncut = sum(law.parts(contact.law, p_mm * 1e-3, closing / 1e3))
    assert uncut < -5.0 if closing < 0.0 else uncut == pytest.approx(force, abs=5e-4)
    if 0.0 < closing and p_mm < 0.3:
        assert K * (p_mm * 1e-3) ** 1.5 + 60000.0 * closing / 1e3 > force + 500.0


@pytest.mark.case("O21")
@TWO_TOLERANCES
@pytest.mark.parametrize("damping", [60000.0, 0.0])
def test_impact_collision(tolerance, damping):
    """m p'' = -F(p, p') with IMPACT, against a tight ODE solution by another code."""
    expected = exact.impact_collision(20.0, 0.05, K, 1.5, damping, 3e-4)
    found, run = drop(PAPER_PAD | {"damping": damping}, tolerance, 3.6e-3)
    close(found, expected, 1e-4)
    assert run.checks["energy_error"] <= 1e-6
    # Control: explicit Euler, 360 steps to the contact, misses the restitution by ten times the
    # tolerance.
    euler = exact.explicit_euler_restitution(
        lambda p, q: exact.impact_force(K, 1.5, damping, 3e-4, max(p, 0.0), q), 20.0, 0.05, 1e-5
    )
    assert abs(euler / expected["restitution"] - 1.0) > 1e-3


@pytest.mark.case("O22")
@TWO_TOLERANCES
@pytest.mark.parametrize("n", [1.0, 3.0])
def test_undamped_power_law(tolerance, n):
    """p = ((n+1) m v^2 / 2k)^(1/(n+1)), T by Gamma functions; no energy is lost."""
    k = 70000.0 * 1000.0**n
    expected = exact.power_law_collision(20.0, 0.05, k, n)
    found, _ = drop(
        PAPER_PAD | {"exponent": n, "stiffness": k, "damping": 0.0}, tolerance, expected["duration"]
    )
    close(found, expected, 1e-5)
    assert found["restitution"] == pytest.approx(1.0, abs=1e-6)
    # Control: explicit Euler with a thousand steps to the contact still gains energy.
    euler = exact.explicit_euler_restitution(
        lambda p, _: k * max(p, 0.0) ** n, 20.0, 0.05, expected["duration"] / 1000
    )
    assert euler > 1.0 + 1e-3


@pytest.mark.case("X1")
@TWO_TOLERANCES
def test_thousandfold_stiffness(tolerance):
    """The step falls by itself: p 3.80463 um, F 16427.3 N, T 223.962 us."""
    stiff = PAPER_PAD | {"stiffness": 1e3 * K, "damping": 0.0, "clearance": 1e-6}
    expected = exact.power_law_collision(20.0, 0.05, 1e3 * K, 1.5)
    assert expected["duration"] == pytest.approx(223.962e-6, rel=1e-5)
    found, run = drop(stiff, tolerance, expected["duration"])
    close(found, expected, 1e-3)
    assert found["restitution"] == pytest.approx(1.0, abs=1e-4)
    assert run.checks["energy_error"] <= 1e-3 and run.cost["limit_used"] <= 1.0
    # Control: explicit Euler at a step that serves the paper's pad well invents energy here.
    euler = exact.explicit_euler_restitution(
        lambda p, _: exact.impact_force(1e3 * K, 1.5, 0.0, 3e-4, max(p, 0.0), 0.0), 20.0, 0.05, 1e-5
    )
    assert euler > 1.2


@pytest.mark.case("O19")
@pytest.mark.parametrize("av", [0.15, 0.75, 3.0])
def test_hunt_crossley_restitution(av):
    """a v (1 + e) = ln[(1 + a v)/(1 - a v e)] for any k, m and n; control: the linear law 1 - 2 a v
    / 3 is off."""
    expected, results = exact.hunt_crossley_restitution(av), []
    for n, mass, tolerance in (
        (1.0, 20.0, 1e-7),
        (1.5, 20.0, 1e-9),
        (2.2, 3.0, 1e-9),
        (1.5, 3.0, 1e-7),
    ):
        k = 70000.0 * 1000.0**n
        pad = {
            "law": "hunt-crossley",
            "clearance": 1e-5,
            "exponent": n,
            "stiffness": k,
            "dissipation": av / 0.05,
        }
        found, run = drop(
            pad, tolerance, 3.0 * exact.power_law_collision(mass, 0.05, k, n)["duration"], mass=mass
        )
        results.append(found["restitution"])
        assert run.checks["damping_power_max"] <= 0.0
    assert results == pytest.approx([expected] * len(results), abs=1e-5)
    assert max(results) - min(results) <= 1e-6
    assert abs((1.0 - 2.0 * av / 3.0) - expected) > 1e-3


@pytest.mark.case("O23")
@TWO_TOLERANCES
@pytest.mark.parametrize("zeta", [0.1, 0.6])
def test_linear_spring_damper_never_pulls(tolerance, zeta):
    """e = exp[-(z/s)(pi - atan2(2zs, 1-2z^2))]; were pulling allowed it would be exp(-pi z/s)."""
    pad = {
        "law": "linear",
        "clearance": 1e-5,
        "stiffness": 7e7,
        "damping": 2.0 * zeta * math.sqrt(7e7 * 20.0),
    }
    found, run = drop(pad, tolerance, 2e-3, gravity={"z": 0.0})
    assert found["restitution"] == pytest.approx(exact.linear_restitution(zeta), abs=1e-5)
    pulling = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta * zeta))
    assert abs(found["restitution"] - pulling) > 1e-2  # control: that of a law that may pull
    assert (run.pad_force[:, :, 2] >= 0.0).all()
    assert run.energy[-1, -2] > 0.0 and run.checks["energy_error"] <= 1e-6


@pytest.mark.case("X5")
@TWO_TOLERANCES
def test_flat_drop_on_eight_pads(tolerance):
    """Eight equal linear pads: T = pi sqrt(m / 8k), F = v sqrt(8 k m) / 8 each, no spin in any
    order of the pads."""
    places = [(x, y, -0.1) for x in (-0.2, -0.1, 0.1, 0.2) for y in (-0.1, 0.1)]
    pads = [{"position": place, "normals": ["-z"]} for place in places]
    linear = {"law": "linear", "clearance": 1e-5, "stiffness": 7e7, "damping": 0.0}
    runs = []
    for order in (pads, pads[::-1], pads[3:] + pads[:3]):
        found, run = drop(linear, tolerance, 593.706e-6, pads=order, along=0.0, gravity={"z": 0.0})
        close(found, {"duration": 593.706e-6, "force": 8 * 661.438, "restitution": 1.0}, 1e-4)
        assert abs(run.rate).max() <= 1e-12
        runs.append(run.velocity)
    assert abs(runs[0] - runs[1]).max() <= 1e-12 and abs(runs[0] - runs[2]).max() <= 1e-12
    # Control: explicit Euler at a fifth of the period gains energy.
    assert exact.explicit_euler_restitution(lambda p, _: 8 * 7e7 * p, 20.0, 0.05, 1e-4) > 1.5


@pytest.mark.case("O31")
@TWO_TOLERANCES
@pytest.mark.parametrize("k, duration", [(7e7, 1.679252e-3), (2.8e8, 0.839626e-3)])
def test_penalty_converges(tolerance, k, duration):
    """On a linear pad T = pi sqrt(m / k), and N / k at rest: four times the stiffness, half the
    time, a quarter of the depth."""
    pad = {"law": "linear", "clearance": 1e-5, "stiffness": k, "damping": 0.0}
    assert math.pi * math.sqrt(20.0 / k) == pytest.approx(duration, rel=1e-6)
    found, _ = drop(pad, tolerance, duration, gravity={"z": 0.0})
    assert found["duration"] == pytest.approx(duration, rel=1e-4)
    damped = pad | {"clearance": 0.0, "damping": 2.0 * math.sqrt(20.0 * k)}
    resting = lowfi.run(
        scene(0.05, 1e-3, contact=damped, gravity={"z": -G}, initial={"velocity": {"x": 1.0}}),
        "springs",
        numerics=numerics(tolerance),
    )
    assert resting.status == "time_limit"
    assert -resting.position[-1, 2] == pytest.approx(20.0 * G / k, rel=1e-4)
