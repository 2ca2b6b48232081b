"""Contacts at the ends of their range: pads pressed in from the start, grazing, very short, pushed
over the rail's end; slopes that are infinite or zero at first contact, and a body of one gram."""

import math

import numpy as np
import pytest

from tests.exact import contact as exact
from tests.exact.rigid import elastic_impact
from tests.lowfi.support import ONE_PAD, PAPER_PAD, RAIL, close, drop, numerics, scene
from tipoff import lowfi
from tipoff.lowfi import state
from tipoff.lowfi.dynamics import integrate
from tipoff.lowfi.faces import WALL
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics import ledger
from validation.stability import weaker_methods as weaker

LINEAR = PAPER_PAD | {"exponent": 1.0, "stiffness": 7e7, "damping": 0.0}
STORED = ledger.ENTRIES.index("contact_stored")
TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-7, 1e-9])
DEFAULT_STEP = 1e-4  # s: what a careless user of a fixed-step code would take


@pytest.mark.case("X3")
@TWO_TOLERANCES
@pytest.mark.parametrize(
    "contact, stored, leaves",
    [(LINEAR, 14.0e-3, 37.417e-3), (PAPER_PAD | {"damping": 0.0}, 1.58392e-3, 12.585e-3)],
)
def test_initial_interference(contact, stored, leaves, tolerance):
    """Pressed in by 20 um: E = k p^(e+1)/(e+1) per pad is in the ledger from the start and becomes
    m v^2 / 2."""
    # The body starts 20 um deeper than centred with no clearance.
    run = lowfi.run(
        scene(
            0.02,
            1e-5,
            contact=contact | {"clearance": 0.0},
            initial={"position": {"z": -20e-6}, "velocity": {"x": 1.0}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    assert run.energy[0, STORED] == pytest.approx(stored, rel=1e-5)
    assert run.velocity[-1, 2] == pytest.approx(leaves, rel=1e-4)
    assert "pads 0" in run.message and run.checks["energy_error"] <= 1e-6
    # Controls: a ledger that begins with nothing stored does not close, and explicit Euler throws
    # the body out too fast.
    forgetful = run.energy.copy()
    forgetful[0, STORED] = 0.0
    assert ledger.total_error(forgetful) > 1e-4
    stiffness, exponent = contact["stiffness"], contact["exponent"]
    _, thrown = weaker.explicit_euler(
        lambda _, p, __: -stiffness * max(p, 0.0) ** exponent / 20.0, 20e-6, 0.0, DEFAULT_STEP, 50
    )
    assert -thrown > 1.01 * leaves


@pytest.mark.case("X3")
@TWO_TOLERANCES
@pytest.mark.parametrize(
    "contact, stored", [(LINEAR, 14.0e-3), (PAPER_PAD | {"damping": 0.0}, 1.58392e-3)]
)
def test_opposed_interference_is_in_equilibrium(contact, stored, tolerance):
    """Walls 20 um closer than the pads on either side: no net force, no motion, both pads named,
    twice the energy throughout."""
    opposed = [
        {"position": (0.0, 0.0, side * 0.1), "normals": [sign]}
        for side, sign in ((-1, "-z"), (1, "+z"))
    ]
    asked = scene(0.004, 1e-4, pads=opposed, contact=contact | {"clearance": 0.0})
    run = SingleRun(asked, numerics(tolerance))
    run.cases.faces[..., WALL] -= 20e-6  # a scene has no negative clearance, walls bent inwards do
    run.loop = integrate.ready(run.system, state.initial(run.model), run.interval)
    run.begin()
    run.integrate(None)
    both = run.trajectory()
    assert (np.abs(both.pad_force[:, :, 2]) > 100.0).all() and np.abs(
        both.pad_force.sum(axis=1)
    ).max() <= 1e-9
    assert np.abs(both.velocity).max() <= 1e-12 and "pads 0, 1" in both.message
    assert both.energy[:, STORED] == pytest.approx(2.0 * stored, rel=1e-5)


@pytest.mark.case("X4")
@TWO_TOLERANCES
def test_grazing_contact_is_found(tolerance):
    """A rough wall approached at 1 um/s while passing at 5 m/s."""
    run = lowfi.run(
        scene(
            0.02,
            1e-4,
            contact={"law": "linear", "clearance": 1e-9, "stiffness": 7e7, "damping": 0.0},
            friction={"static": 0.3, "dynamic": 0.3, "static_speed": 1e-3, "dynamic_speed": 2e-3},
            gravity={"z": 0.0},
            initial={"velocity": {"x": 5.0, "z": -1e-6}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    assert (run.pad_force[:, 0, 2] > 0.0).any() and run.cost["events"] >= 1
    assert run.checks["linear_momentum_error"] <= 1e-12 and run.checks["friction_power_max"] <= 0.0
    assert run.velocity[-1, 0] < 5.0 and run.energy[-1, ledger.ENTRIES.index("friction")] > 0.0


@pytest.mark.case("X4")
@TWO_TOLERANCES
def test_contact_shorter_than_a_step_is_found(tolerance):
    """A wall so stiff that the contact lasts 2 us, while the first step of free flight that meets
    it is a thousand times longer."""
    run = lowfi.run(
        scene(
            0.05,
            1e-3,
            contact=LINEAR | {"stiffness": 7e13, "clearance": 1e-3},
            initial={"velocity": {"x": 5.0, "z": -0.05}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    assert run.velocity[-1, 2] == pytest.approx(0.05, rel=1e-5)
    # Control: fixed steps of 0.1 ms find the pad deep in the wall and shoot it out.
    _, thrown = weaker.runge_kutta(
        lambda _, p, __: -7e13 * max(p, 0.0) / 20.0, -1e-6, 0.05, DEFAULT_STEP, 10
    )
    assert abs(thrown) > 1.0


@pytest.mark.case("X6")
@TWO_TOLERANCES
@pytest.mark.parametrize(
    "contact, stored", [(LINEAR, 1.78571e-3), (PAPER_PAD | {"damping": 0.0}, 7.41785e-3)]
)
def test_pad_leaves_the_rail_end_under_load(contact, stored, tolerance):
    """A pad pressed with 500 N passes the end: its energy is released or has become motion, and no
    force follows."""
    depth = (500.0 / contact["stiffness"]) ** (1.0 / contact["exponent"])
    run = lowfi.run(
        scene(
            0.03,
            1e-5,
            pads=ONE_PAD,
            contact=contact | {"clearance": 0.0},
            rail=RAIL | {"end": 1e-9},
            initial={"position": {"z": -depth}, "velocity": {"x": 5.0}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    entry = {name: run.energy[:, index] for index, name in enumerate(ledger.ENTRIES)}
    assert entry["contact_stored"][0] == pytest.approx(stored, rel=1e-5)
    assert (
        entry["released"][-1] == pytest.approx(stored, rel=1e-4)
        and entry["contact_stored"][-1] == 0.0
    )
    assert (run.pad_force[1:] == 0.0).all()
    assert abs(run.velocity[-1, 2]) <= math.sqrt(2.0 * stored / 20.0)
    assert run.checks["energy_error"] <= 1e-9
    # Control: a ledger without that entry, the usual one, does not close.
    usual = run.energy.copy()
    usual[:, ledger.ENTRIES.index("released")] = 0.0
    assert ledger.total_error(usual) > 1e-6


@pytest.mark.case("X9")
@TWO_TOLERANCES
@pytest.mark.parametrize(
    "n, k, answer",
    [
        (0.5, 7e5, (14.2109e-6, 2638.82, 0.980405e-3)),
        (3.0, 7e13, (0.194413e-3, 514.369, 10.19525e-3)),
    ],
)
def test_exponents_below_and_far_above_one(tolerance, n, k, answer):
    """k p^0.5 rises infinitely steeply at p = 0, k p^3 not at all: penetration, force and time
    within 1 %, and not one NaN."""
    expected = exact.power_law_collision(20.0, 0.05, k, n)
    assert tuple(expected.values()) == pytest.approx(answer, rel=1e-5)
    found, run = drop(
        PAPER_PAD | {"exponent": n, "stiffness": k, "damping": 0.0}, tolerance, expected["duration"]
    )
    close(found, expected | {"restitution": 1.0}, 1e-2)
    assert (
        np.isfinite(run.pad_force).all()
        and run.checks["energy_error"] <= 1e-6
        and run.cost["limit_used"] <= 1.0
    )
    # controls: a step from the slope at first contact does not exist, and a fixed one gains energy
    if n < 1.0:
        with np.errstate(divide="ignore"):
            assert np.isinf(n * k * np.float64(0.0) ** (n - 1.0))
        assert (
            exact.explicit_euler_restitution(
                lambda p, _: k * max(p, 0.0) ** n, 20.0, 0.05, DEFAULT_STEP
            )
            > 1.05
        )


@pytest.mark.case("X10")
@pytest.mark.parametrize("tolerance", [1e-8, 1e-10])
def test_light_payload_on_a_heavy_platform(tolerance):
    """1 g against 150 kg on 7e7 N/m: steps stay below 2 sqrt(m / k) = 7.5593 us, both speeds and
    the momentum are right to 1e-6."""
    light, heavy, k, v, gap = 1e-3, 150.0, 7e7, 1.0, 1e-6
    inertia = dict.fromkeys(("xx", "yy", "zz"), 0.4 * light * 0.05**2)
    run = lowfi.run(
        scene(
            3e-5,
            1e-6,
            mass=light,
            inertia=inertia,
            pads=[{"position": (0.0, 0.05, 0.0), "normals": ["+y"]}],
            platform={"mass": heavy, "inertia": dict.fromkeys(("xx", "yy", "zz"), 10.0)},
            contact=LINEAR | {"clearance": gap},
            # Friction, thrust and offset of nothing, so that this scene runs on the kernel of the
            # catalogue's.
            friction={"static": 0.0, "dynamic": 0.0, "static_speed": 0.01, "dynamic_speed": 0.02},
            thrust={"kind": "gaussian", "peak": 0.0, "width": 1e-3, "centre": 1e-3},
            initial={"velocity": {"y": v}},
        ),
        "springs",
        numerics=lowfi.Numerics(relative_tolerance=tolerance),
    )
    critical = 2.0 * math.sqrt(light * heavy / (light + heavy) / k)
    assert critical == pytest.approx(7.5593e-6, rel=1e-5)
    assert run.cost["dt_limit_s"] < critical and run.cost["limit_used"] <= 1.0
    found = run.velocity[-1, 1], run.platform_velocity[-1, 1]
    assert found == pytest.approx(elastic_impact(light, heavy, v), rel=1e-6)
    assert light * found[0] + heavy * found[1] == pytest.approx(light * v, rel=1e-6)
    # Control: a fixed step of 0.1 ms, thirteen times the critical one, throws the gram out at
    # another speed altogether.
    assert exact.explicit_euler_restitution(lambda p, _: k * p, light, v, DEFAULT_STEP) > 10.0
