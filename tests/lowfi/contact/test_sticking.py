"""Friction that sticks: a block on a slope, a slider that jams with and without a platform, and a
finite number of slips."""

import math

import numpy as np
import pytest

from tests.exact import friction as exact
from tests.lowfi.contact.test_friction import on_slope as smoothed_on_slope
from tests.lowfi.support import G, corners, numerics, scene
from tipoff import highfi, lowfi
from tipoff.mechanics import ledger
from tipoff.scenes import SceneError, load
from validation import oracle

FEET = [{"position": (x, y, 0.0), "normals": ["-z"]} for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
GROUND = {"law": "linear", "clearance": 0.0, "stiffness": 1e8, "damping": 2e4}
SPRING, CRITICAL = 1e7, 2.0 * math.sqrt(1e7 * 5.0)  # of each foot, which carries 5 kg (N/m, N s/m)
GIVES = 0.3 * 20.0 * G / (4.0 * SPRING)  # m, the most that four held feet give on a level plane
TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
FRICTION, STORED = (ledger.ENTRIES.index(name) for name in ("friction", "contact_stored"))


@pytest.fixture
def push(tmp_path):
    """Thrust of a constant force (N) read from a file, under which a run goes on after a jam."""

    def write(force: float) -> dict:
        rows = "\n".join(f"{time},{force}" for time in (0, 1, 2, 3, 4))
        (tmp_path / "push.csv").write_text(f"time_s,force_N\n{rows}\n")
        return {"kind": "measured", "file": str(tmp_path / "push.csv")}

    return write


def on_slope(
    angle,
    speed,
    duration,
    tolerance=1e-6,
    downhill="x",
    stiffness=SPRING,
    damping=CRITICAL,
    thrust=None,
):
    """20 kg with coefficient 0.3 on a plane at ``angle`` (rad), started downhill at ``speed`` (m/s)
    in normal equilibrium."""
    sticking = {
        "law": "sticking",
        "static": 0.3,
        "dynamic": 0.3,
        "stiffness": stiffness,
        "damping": damping,
    }
    sunk = 20.0 * G * math.cos(angle) / 4.0 / GROUND["stiffness"]
    return lowfi.run(
        scene(
            duration,
            1e-3,
            pads=FEET,
            contact=GROUND,
            friction=sticking,
            thrust=thrust,
            initial={"velocity": {downhill: speed}, "position": {"z": -sunk}},
            gravity={downhill: G * math.sin(angle), "z": -G * math.cos(angle)},
        ),
        "springs",
        numerics=numerics(tolerance),
    )


def passive(run) -> bool:
    """Friction took power in every step, and energy between any two samples."""
    return (
        run.checks["friction_power_max"] <= 0.0 and (np.diff(run.energy[:, FRICTION]) >= 0.0).all()
    )


@pytest.mark.case("O24")
@TWO_TOLERANCES
def test_stopping_distance_and_time(tolerance):
    """v^2 / (2 mu g) and v / (mu g), except for the deflection of the springs."""
    run = on_slope(0.0, 2.0, 0.8, tolerance)
    distance, time = exact.stopping(2.0, 0.3, G)
    assert run.status == "jammed" and passive(run)
    assert run.position[-1, 0] == pytest.approx(distance, abs=GIVES)
    assert run.time[np.flatnonzero(run.velocity[:, 0] < 1e-3)[0]] == pytest.approx(time, rel=2e-3)
    spent = run.energy[-1, FRICTION] + run.energy[-1, STORED] - run.energy[0, STORED]
    assert spent == pytest.approx(0.5 * 20.0 * 2.0**2, rel=1e-9)
    assert run.checks["energy_error"] <= 1e-6 and run.checks["transverse_energy_error"] <= 1e-4


@pytest.mark.case("O25")
@TWO_TOLERANCES
def test_sliding_threshold(tolerance, push):
    """atan(mu): a hundredth of a degree below, the block comes to rest for good; as much above, it
    runs away."""
    limit, hundredth = exact.threshold(0.3), math.radians(0.01)
    # So near the limit a slack spring overshoots it, and some more slips load it: the stiffer, the
    # sooner (0.12 s if rigid).
    stiff = {"stiffness": 100.0 * SPRING, "damping": CRITICAL, "thrust": push(1e-12)}
    below = on_slope(limit - hundredth, 2e-4, 0.6, tolerance, **stiff)
    above = on_slope(limit + hundredth, 2e-4, 0.6, tolerance, **stiff)
    assert np.ptp(below.position[below.time > 0.4, 0]) <= 1e-15
    assert passive(below) and below.cost["events"] < 100
    assert above.velocity[-1, 0] == pytest.approx(
        2e-4 + 0.6 * exact.sliding_acceleration(limit + hundredth, 0.3, G), rel=0.01
    )


@pytest.mark.case("O25")
@TWO_TOLERANCES
def test_sliding_acceleration(tolerance):
    """g (sin - mu cos) at 20 deg."""
    run = on_slope(math.radians(20.0), 0.1, 0.5, tolerance)
    half = run.time.size // 2
    found = (run.velocity[-1, 0] - run.velocity[half, 0]) / (run.time[-1] - run.time[half])
    assert found == pytest.approx(exact.sliding_acceleration(math.radians(20.0), 0.3, G), rel=1e-6)


@pytest.mark.case("O25")
@TWO_TOLERANCES
@pytest.mark.parametrize("downhill, speed", [("x", 0.0), ("x", 0.05), ("y", 0.05), ("y", -0.05)])
def test_no_creep(tolerance, downhill, speed, push):
    """At 15 deg the block, once it has come to rest, stays where it is to the last bit that a
    position has."""
    run = on_slope(math.radians(15.0), speed, 0.5, tolerance, downhill, thrust=push(1e-12))
    rest = run.position[run.time > 0.4]
    assert np.ptp(rest, axis=0).max() <= 1e-15
    assert (
        passive(run)
        and run.checks["energy_error"] <= 1e-6
        and run.checks["transverse_energy_error"] <= 1e-4
    )
    assert run.cost["events"] < 20
    # Control: the two-step law creeps from one sample to the next, by 0.72 of its transition speed.
    smoothed = smoothed_on_slope(math.radians(15.0), 0.0, 0.05, 2e-4, tolerance)
    assert np.diff(smoothed.position[:, 0])[-1] == pytest.approx(0.72 * 2e-4 * 1e-3, rel=0.01)


@pytest.mark.parametrize("damping", [0.0, 1e2, 1e5])
@pytest.mark.parametrize("speed", [0.05, -0.05])
def test_slips_come_to_an_end(damping, speed, push):
    """With any damping, even none, a face sticks for good after a few slips, though it may vibrate
    on its spring."""
    run = on_slope(math.radians(15.0), speed, 0.5, damping=damping, thrust=push(1e-12))
    assert run.cost["events"] < 20 and passive(run)
    assert np.ptp(run.position[run.time > 0.4, 0]) <= 2.0 * GIVES


def slider(offset: float, thrust: dict, duration: float, friction: dict):
    """20 kg guided over 0.2 m without clearance and pushed by 2 kN ``offset`` (m) off its
    centre."""
    pads = {"law": "linear", "clearance": 0.0, "stiffness": 7e7, "damping": 3.704e4}
    return lowfi.run(
        scene(
            duration,
            1e-4,
            pads=corners(normals=("z",)),
            inertia={"xx": 0.8, "yy": 0.8, "zz": 0.8},
            contact=pads,
            friction=friction,
            thrust=thrust,
            thrust_offset={"eccentricity": {"axial": offset}},
            gravity={"z": 0.0},
        ),
        "springs",
    )


@pytest.mark.case("X7")
def test_wedged_slider(push):
    """2 mu r/s = 1.04 locks: a jam, less than 0.5 mm of travel and then none at all. 0.96 leaves 4
    % of the force."""
    sticking = {
        "law": "sticking",
        "static": 0.8,
        "dynamic": 0.8,
        "stiffness": 7e7,
        "damping": 3.7e4,
    }
    constant = {"kind": "constant", "force": 2000.0, "duration": 0.2}
    jammed, locked = (
        slider(0.13, constant, 0.2, sticking),
        slider(0.13, push(2000.0), 0.2, sticking),
    )
    assert jammed.status == "jammed" and jammed.outcome.velocity is None
    assert 0.0 < locked.position[-1, 0] < 0.5e-3
    assert np.ptp(locked.position[locked.time > 0.1], axis=0).max() <= 1e-15
    assert locked.cost["events"] < 100 and passive(locked)
    free = slider(0.12, constant, 0.05, sticking)
    assert np.interp([0.02, 0.04], free.time, free.velocity[:, 0]) @ (
        -1.0,
        1.0,
    ) / 0.02 == pytest.approx(4.0, rel=0.02)


WEDGED = {
    "friction": {
        "law": "sticking",
        "static": 0.8,
        "dynamic": 0.7,
        "stiffness": 1e7,
        "damping": 1e4,
    },
    "thrust.peak": 2000.0,
    "thrust_offset.eccentricity.axial": 0.13,
}


def test_promises_of_a_jam_on_a_free_platform():
    """Slips, stops, touches and recoil: both ledgers, both momenta, no energy back, and the mirror
    image at a tolerance at which a stop that rounding moves to another step changes nothing."""
    asked = load("sensitive").condition("phi35").replace(WEDGED)
    mirror = asked.replace(
        {
            "thrust_offset.misalignment.radial": "145 deg",
            "payload.inertia.xy": -asked.payload.inertia.xy,
        }
    )
    run = lowfi.run(asked, "springs")
    fine, other = (lowfi.run(each, "springs", numerics=numerics(1e-9)) for each in (asked, mirror))
    assert run.status == fine.status == other.status == "jammed" and passive(run)
    assert run.checks["energy_error"] <= 1e-6 and run.checks["transverse_energy_error"] <= 1e-4
    assert (
        run.checks["linear_momentum_error"] <= 1e-12
        and run.checks["angular_momentum_error"] <= 1e-11
    )
    assert run.checks["quaternion_error"] <= 1e-12 and 0.0 < run.cost["limit_used"] <= 1.0 + 1e-9
    assert run.cost["events"] < 1000
    assert other.rate * (-1.0, 1.0, -1.0) == pytest.approx(
        fine.rate, abs=1e-6 * np.abs(fine.rate).max()
    )
    # Control: a hundredth less of the loss is seen.
    false = run.energy.copy()
    false[:, FRICTION] *= 0.99
    assert ledger.total_error(false) > 1e-6


def test_fast_faces_only_slide():
    """At metres per second the law is Coulomb's, and so is the two-step law: the same ejection."""
    asked = load("sensitive").condition("phi60")
    one = lowfi.run(asked, "springs").outcome.rate
    other = lowfi.run(
        asked.replace({"friction": WEDGED["friction"] | {"static": 0.2, "dynamic": 0.2}}), "springs"
    ).outcome.rate
    assert other == pytest.approx(one, rel=1e-6)


@pytest.mark.slow
def test_same_bits_in_an_ensemble():
    slippery = WEDGED | {"friction.static": 0.3, "friction.dynamic": 0.2, "thrust.peak": "10 kN"}
    base = load("sensitive").condition("phi35").replace(slippery)
    rows = [{"thrust_offset.eccentricity.axial": 1e-3 * index} for index in range(3)]
    rows += [
        WEDGED,
        {"friction.dynamic": 0.1},
        {"initial.position.y": 0.06e-3},
        {"friction.dynamic": 0.4},
    ]
    found = lowfi.run_many(base, rows, "springs")
    assert found.status.values.tolist() == ["exited"] * 3 + ["jammed"] + ["exited"] * 2 + [
        "refused"
    ]
    for index, row in enumerate(rows[:-1]):
        alone, case = lowfi.run(base.replace(row), "springs"), found.isel(case=index)
        assert (str(case.status.values), int(case.steps)) == (alone.status, alone.cost["steps"])
        for name in ("rate", "velocity", "exit_time") if alone.status == "exited" else ():
            assert np.array_equal(case[name].values, getattr(alone.outcome, name)), (row, name)


def test_evaluated_only_where_the_scene_has_it():
    present = lowfi.evaluations(load("sensitive").replace(WEDGED))
    assert present["sticking"] and not present["friction"]


@pytest.mark.parametrize("solver", [highfi.run, lambda scene: oracle.solve(scene, 1)])
def test_solvers_without_it_refuse(solver):
    with pytest.raises(SceneError, match="friction.law: given 'sticking', expected 'two-step'"):
        solver(load("sensitive").replace(WEDGED))
