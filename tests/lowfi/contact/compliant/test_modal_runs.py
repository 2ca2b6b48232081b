"""Runs on rails that vibrate: a moving force, free vibration of a rail, ledgers, and the limit of
rails without inertia."""

from dataclasses import replace

import numpy as np
import pytest

from tests.exact import elasticity
from tests.lowfi.compliance import (
    REFERENCE,
    Pose,
    handmade,
    in_one_cell,
    pressed,
    reference_compliance,
)
from tests.lowfi.contact.compliant.test_modes import DAMPED, pull_of_modes
from tests.lowfi.contact.compliant.test_runs import EFFECTS, RUB, TIGHT, on_springs
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.lowfi import state as slot
from tipoff.lowfi.dynamics import integrate
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics import ledger
from tipoff.mechanics.rail_compliance import PATTERNS

VIBRATING, TIGHT_VIBRATING = Numerics(modes=4), replace(TIGHT, modes=4)
# A beam as in tests/highfi/dynamics/test_moving_force.py.
LENGTH, WIDTH, HEIGHT, MODULUS, DENSITY = 0.8, 0.02, 0.01, 72e9, 2810.0
CRITICAL = np.pi / LENGTH * elasticity.bar_speed(MODULUS, DENSITY) * HEIGHT / np.sqrt(12.0)
# N/m and m of the spring that is the force: it changes by 1e-4 as the beam deflects
STIFFNESS, PUSHED = 1.0, 1e-3


def sampled(run: SingleRun) -> np.ndarray:
    """Runs ``run`` to its end; the whole state (n,k) at every sample."""
    run.begin()
    found = [run.loop.work.copy()]
    while run.taken <= run.end and not run.message:
        run.advance(run.taken)
        found.append(run.loop.work.copy())
    return np.array(found[: run.taken])  # a run may end before the last one requested


def crossing(ratio: float):
    """A heavy payload with one pad, pushed into a simply supported beam by a soft spring, crosses
    it at ``ratio`` of the critical speed; its walls are sums of sines."""
    heavy = {"inertia": {"xx": 1e6, "yy": 1e6, "zz": 1e6}}
    pads = [
        {
            "position": (0.0, 0.1, 0.1),
            "normals": ["+y"],
            "length": 0.016,
            "width": 0.016,
            "inset": 0.009,
            "relief": 0.0,
        }
    ]
    duration = LENGTH / (ratio * CRITICAL)
    asked = on_springs(
        RUB | {"static": 0.0, "dynamic": 0.0},
        interface_stiffness=STIFFNESS / 0.016**2,
        pads=pads,
        duration=duration,
        payload=heavy | {"mass": 1e4},
        platform=heavy | {"mass": 1e9, "mass_centre": {"x": 0.0}},
        thrust=EFFECTS["thrust"] | {"peak": 0.0},
        initial={"position": {"y": 1e-4 + PUSHED}, "velocity": {"x": ratio * CRITICAL}},
        output={"interval": duration / 400},
    )
    travel, number = np.linspace(0.0, LENGTH, 101), np.arange(1, 21)
    frequency = (
        (number * np.pi / LENGTH) ** 2
        * elasticity.bar_speed(MODULUS, DENSITY)
        * HEIGHT
        / np.sqrt(12.0)
    )
    sines = np.sqrt(2.0 / (DENSITY * WIDTH * HEIGHT * LENGTH)) * np.sin(
        np.pi * number * travel[:, None] / LENGTH
    )
    flexibility, shape = np.zeros((101, 1, 1, PATTERNS, PATTERNS)), np.zeros((101, 1, PATTERNS, 20))
    flexibility[:, 0, 0, 0, 0], shape[:, 0, 0] = (sines**2 / frequency**2).sum(axis=1), sines
    return asked, replace(
        handmade(asked, {}),
        travel=travel,
        flexibility=flexibility,
        shape=shape,
        frequency=frequency[None],
    )


def midspan(ratio: float, modes: int) -> tuple[np.ndarray, np.ndarray]:
    """Share of the span done, and deflection in the middle of it over the static one."""
    asked, compliance = crossing(ratio)
    states = sampled(
        SingleRun(
            asked, Numerics(relative_tolerance=1e-8, speed_floor=1e-9, modes=modes), compliance
        )
    )
    middle = np.sqrt(2.0 / (DENSITY * WIDTH * HEIGHT * LENGTH)) * np.sin(
        0.5 * np.pi * np.arange(1, modes + 1)
    )
    deflection = states[:, slot.STATE_SIZE : slot.STATE_SIZE + modes] @ middle
    static = STIFFNESS * PUSHED * LENGTH**3 / (4.0 * MODULUS * WIDTH * HEIGHT**3)
    return states[:, slot.PAYLOAD] / LENGTH, deflection / static


@pytest.mark.case("O16")
@pytest.mark.parametrize("ratio, factor, place", [(0.5, 1.70545, 0.6667), (0.25, 1.25761, 0.4021)])
def test_moving_force(monkeypatch, ratio, factor, place):
    in_one_cell(monkeypatch)
    way, deflection = midspan(ratio, 9)
    assert deflection.max() == pytest.approx(factor, rel=1e-3)
    assert way[deflection.argmax()] == pytest.approx(place, abs=0.005)
    assert np.abs(deflection - elasticity.moving_force_deflection(ratio, way)).max() < 1e-3 * factor
    # Control: one mode for nine, though static deflection has all of them either way, is off by
    # five times as much.
    way, deflection = midspan(ratio, 1)
    assert np.abs(deflection - elasticity.moving_force_deflection(ratio, way)).max() > 5e-3 * factor


def test_a_rail_rings_out():
    """Every mode by itself is a damped oscillator, and the ledger accounts for its energy."""
    still = {
        "thrust.peak": 0.0,
        "duration": 2e-3,
        "output.interval": 1e-5,
        "friction.static": 0.0,
        "friction.dynamic": 0.0,
    }
    run = SingleRun(REFERENCE.replace(still | DAMPED), TIGHT_VIBRATING, reference_compliance())
    modes = run.system.compliance.modes
    start = 1e-7 * np.random.default_rng(2).standard_normal(modes.square.size)
    begun = np.concatenate([run.loop.start[: slot.STATE_SIZE], start, 0.0 * start])
    run.loop = integrate.ready(run.system, begun, run.plan.first)
    states, (square, drag) = sampled(run), (modes.square.ravel(), modes.drag.ravel())
    found, time = run.trajectory(), run.interval * np.arange(len(states))[:, None]
    fast = np.sqrt(square - 0.25 * drag**2)
    exact = (
        start
        * np.exp(-0.5 * drag * time)
        * (np.cos(fast * time) + 0.5 * drag / fast * np.sin(fast * time))
    )
    assert states[:, slot.STATE_SIZE : slot.STATE_SIZE + start.size] == pytest.approx(
        exact, abs=1e-6 * np.abs(start).max()
    )
    stored, spent = (
        found.energy[:, ledger.STATE].sum(axis=1),
        found.energy[:, ledger.ENTRIES.index("structural_damping")],
    )
    assert stored[-1] < 0.5 * stored[0] and spent[-1] == pytest.approx(
        stored[0] - stored[-1], rel=1e-6
    )
    assert stored[0] == pytest.approx(0.5 * (square * start**2).sum(), rel=1e-12)
    assert found.checks["energy_error"] < 1e-6 and not found.velocity.any()


@pytest.mark.parametrize(
    "condition, changes", [("phi35", {}), ("h7", DAMPED)], ids=["phi35", "damped, over the end"]
)
def test_ledgers_and_momentum(condition, changes):
    """With default numerics; residuals fall with the tolerance."""
    asked, compliance = REFERENCE.condition(condition).replace(changes), reference_compliance()
    run = SingleRun(asked, VIBRATING, compliance)
    states, fine = sampled(run), lowfi.run(asked, numerics=TIGHT_VIBRATING, compliance=compliance)
    coarse = run.trajectory()
    for found in (coarse, fine):
        checks = found.checks
        assert found.status == "exited" and found.cost["limit_used"] <= 1.0 + 1e-9
        assert (
            checks["linear_momentum_error"] <= 1e-12 and checks["angular_momentum_error"] <= 1e-11
        )
        assert checks["energy_error"] <= 1e-6 and checks["transverse_energy_error"] <= 1e-4
    assert fine.checks["transverse_energy_error"] < 0.1 * coarse.checks["transverse_energy_error"]
    assert np.degrees(fine.outcome.rate) == pytest.approx(np.degrees(coarse.outcome.rate), abs=0.01)
    assert (fine.energy[-1, ledger.ENTRIES.index("structural_damping")] > 0.0) == bool(changes)
    # Control: without the way along the rail that bent walls lean the transverse ledger would miss
    # tens of times what it may.
    assert (
        work_of_modes(asked, compliance, coarse, states)
        > 1e-3 * np.abs(coarse.transverse_energy[:, ledger.STATE].sum(axis=1)).max()
    )


def test_no_step_is_too_long_for_the_highest_mode():
    """At a tolerance that allows errors of centimetres per second the proven limit alone bounds the
    steps, and no mode grows."""
    asked, compliance = REFERENCE.condition("phi60"), reference_compliance()
    loose, fine = (
        lowfi.run(asked, numerics=each, compliance=compliance)
        for each in (Numerics(relative_tolerance=1e-2, speed_floor=10.0, modes=4), VIBRATING)
    )
    assert loose.status == "exited" and 0.9 < loose.cost["limit_used"] <= 1.0 + 1e-9
    assert np.degrees(loose.outcome.rate) == pytest.approx(np.degrees(fine.outcome.rate), abs=0.1)
    strain = ledger.ENTRIES.index("strain")
    assert loose.energy[:, strain].max() < 1.2 * fine.energy[:, strain].max()


def test_few_steps_are_refused_where_the_limit_alone_bounds_them():
    """While a pad presses on, the bound grows from step to step, and a step at the limit of its start
    is too long at its end: each second attempt would be refused."""
    loose = Numerics(relative_tolerance=1e-2, modes=4)
    found = lowfi.run(
        REFERENCE.condition("phi60"), compliance=reference_compliance(), numerics=loose
    )
    assert found.cost["limit_used"] > 0.9
    assert found.cost["rejected"] < 0.25 * found.cost["steps"]


def work_of_modes(scene, compliance, run, states) -> float:
    """Most work (J) by any time of the pull along the rail that comes from its modes."""
    model, system = pressed(scene, compliance, VIBRATING.modes)
    poses = [
        Pose(*row)
        for row in zip(
            run.position,
            map(tuple, run.quaternion),
            run.platform_position,
            map(tuple, run.platform_quaternion),
        )
    ]
    pulls = [
        pull_of_modes(system, model, pose, state[slot.STATE_SIZE :])
        for pose, state in zip(poses, states)
    ]
    power = np.array(pulls) * (run.velocity[:, 0] - run.platform_velocity[:, 0])
    return np.abs(np.cumsum(power)).max() * (run.time[1] - run.time[0])


def test_rails_without_inertia_are_the_walls_of_statics():
    """Frequencies go to infinity at the same statics: the effect of vibration falls with their
    square, four times for twice the frequency. Touches at another phase of the vibration may hide a
    little of it."""
    asked, compliance = REFERENCE.condition("phi60"), reference_compliance()
    static = lowfi.run(asked, numerics=TIGHT, compliance=compliance).outcome.rate
    change = []
    for lighter in (1.0, 2.0, 4.0):
        faster = replace(
            compliance, frequency=lighter * compliance.frequency, shape=lighter * compliance.shape
        )
        change.append(
            np.abs(
                np.subtract(
                    lowfi.run(asked, numerics=TIGHT_VIBRATING, compliance=faster).outcome.rate,
                    static,
                )
            ).max()
        )
    assert change[1] < change[0] / 3.0 and change[2] < change[1] / 3.0
    assert np.degrees(change[0]) > 1e-3  # control: inertia does something


@pytest.mark.slow
def test_ensembles_give_the_same_bits():
    compliance, rows = reference_compliance(), [{}, {"payload.mass": 10.0}, DAMPED]
    found = lowfi.run_many(REFERENCE, rows, compliance=compliance, numerics=VIBRATING, workers=2)
    for row, rate in zip(rows, found.rate.values):
        assert np.array_equal(
            rate,
            lowfi.run(
                REFERENCE.replace(row), compliance=compliance, numerics=VIBRATING
            ).outcome.rate,
        )
    assert len({tuple(rate) for rate in found.rate.values}) == 3
