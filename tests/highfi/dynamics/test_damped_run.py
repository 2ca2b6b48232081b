"""Runs with structural damping of the rails: ledgers, momenta, the same bits by any threads and
after a resume, the compiled code."""

import functools
import tempfile
from pathlib import Path

import numpy as np
import pytest

from tests.highfi.dynamics import test_elastic as test_kernels
from tests.highfi.dynamics.test_damping import scene
from tests.highfi.dynamics.test_elastic import TWO_SCENES
from tests.highfi.support import (
    COARSE,
    SOON,
    assert_same_bits,
    bar_mesh,
    begun,
    go_on,
    last_sample,
    loop_on,
    spinning_bar_stretch,
    tiny,
)
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics.checkpoint import Checkpoint, arrays, restore
from tipoff.mechanics import ledger

DAMPED = {"rail__damping__frequencies": ["500 Hz", "5 kHz"], "rail__damping__ratios": [0.05, 0.01]}
EARLY = {"duration": "9 ms", "contact__clearance": "0.05 mm"}
ENTRY = ledger.ENTRIES.index("structural_damping")


def finished(loop):
    """The result of a loop that has begun."""
    loop.integrate(None)
    return loop.trajectory({}, COARSE)


@pytest.mark.parametrize(
    "change",
    [
        SOON,
        pytest.param(EARLY, marks=pytest.mark.slow),
        pytest.param(
            EARLY | {"platform": None, "gravity__z": "-9.81 m/s**2"}, marks=pytest.mark.slow
        ),
    ],
    ids=["soon", "early", "weight"],
)
def test_ledgers_close_and_momenta_are_kept(change):
    """Controls: without its entry the transverse ledger is open by what the entry holds; without
    the force and moment on the frame, momentum would change in one sample by far more than it does
    in all."""
    loop = begun(tiny(**DAMPED, **change))
    found = finished(loop)
    assert np.abs(found.pad_force).max() > 1.0
    lost = found.energy[:, ENTRY]
    assert lost[0] == 0.0 < lost[-1] and (np.diff(lost) >= 0.0).all()
    np.testing.assert_array_equal(found.transverse_energy[:, ENTRY], lost)
    assert found.checks["energy_error"] <= 1e-5 and found.checks["transverse_energy_error"] <= 1e-4
    assert (
        found.checks["linear_momentum_error"] <= 1e-12
        and found.checks["angular_momentum_error"] <= 1e-10
    )
    without = found.transverse_energy.copy()
    without[:, ENTRY] = 0.0
    assert ledger.transverse_error(without) > 10.0 * found.checks["transverse_energy_error"]
    assert np.abs(ledger.residual(without))[-1] == pytest.approx(lost[-1], rel=1e-3)
    force, moment = (
        np.linalg.norm(loop.stepper.state.history.drag.sum(axis=0).reshape(2, 3), axis=1) * 1e-4
    )
    payload = np.linalg.norm(found.velocity[-1]) * 9.9
    assert force > 1e-11 * payload and moment > 1e-9 * payload * np.linalg.norm(found.position[-1])


@pytest.mark.slow
def test_a_rail_that_turns_with_its_frame_is_not_damped():
    """Started suddenly, a bar at 20 rad/s swings about rho w^2 L^3 / (3 E), and damping by mass
    ends that. It takes no more than the energy of the swing. Control: on the velocity in space it
    would take alpha times twice the bar's energy, all the time."""
    density, modulus, length, rate, width = 2810.0, 72e9, 0.6, 20.0, 0.02
    turning = scene({"frequencies": [500.0, 5000.0], "ratios": [0.1, 0.01]}).replace(
        {
            "duration": 0.02,
            "output.interval": 1e-5,
            "rail.end": length,
            "initial.platform_rate.z": rate,
            "platform": {"mass": 1e6, "inertia": {"xx": 1e6, "yy": 1e6, "zz": 1e6}},
            # its tip is faster than contact search allows
            "contact": None,
            "friction": None,
        }
    )
    loop = loop_on(turning, bar_mesh(length, width, 30))
    assert (
        loop.setup.system.rail.damping.mass_rate > 600.0
        and loop.setup.system.rail.damping.stiffness_time < 1e-12
    )
    tip = loop.setup.system.number[loop.setup.system.mesh.points[:, 0] == length]
    loop.begin()
    stretch = []
    for _ in range(last_sample(loop)):
        loop.advance_one_sample()
        stretch.append(loop.stepper.state.displacement[tip, 0].mean())
    found = loop.trajectory({}, Numerics())
    exact = spinning_bar_stretch(density, rate, length, modulus)
    assert max(stretch) > 1.5 * exact
    assert stretch[-1] == pytest.approx(exact, rel=0.02)
    swing = 0.5 * modulus * width**2 / length * exact**2
    in_space = (
        loop.setup.system.rail.damping.mass_rate
        * density
        * width**2
        * length**3
        / 3.0
        * rate**2
        * found.time[-1]
    )
    assert 0.1 * swing < found.energy[-1, ENTRY] < 3.0 * swing < 1e-3 * in_space
    assert found.platform_rate[-1, 2] == pytest.approx(rate, rel=1e-6)


@functools.cache
def whole(kernel: str, named: str):
    """The result of a run of ``test_elastic`` with damping that nothing interrupts."""
    return finished(test_kernels.begun(kernel, named, **DAMPED))


@functools.cache
def halted(kernel: str, named: str) -> dict:
    """What is read from a checkpoint at three fifths of that run."""
    half = test_kernels.begun(kernel, named, **DAMPED)
    go_on(half, 3 * last_sample(half) // 5)
    with tempfile.TemporaryDirectory() as folder:
        kept = Checkpoint(Path(folder) / "run", 0.0, half, test_kernels.NUMERICS)
        kept.write(half)
        return kept.read()


@pytest.mark.case("X20")
@TWO_SCENES
@pytest.mark.parametrize("kernel", ["columns", pytest.param("elements", marks=pytest.mark.slow)])
def test_threads_and_a_resume_do_not_change_a_bit(kernel, scene):
    """One thread makes the whole run; the run that is resumed ends with three."""
    expected, saved = whole(kernel, scene), halted(kernel, scene)
    assert np.abs(expected.pad_force).max() > 1.0 and expected.energy[-1, ENTRY] > 0.0
    assert np.abs(saved["state.history.force"]).max() > 0.0
    second = test_kernels.begun(kernel, scene, 3, **DAMPED)
    restore(second, saved)
    result = finished(second)
    assert_same_bits(result, expected)


@pytest.mark.case("X20")
@TWO_SCENES
def test_a_resume_that_forgets_the_step_before_is_seen(scene):
    """Control: with the history left as a run begins, the resumed run goes another way."""
    second = test_kernels.begun("columns", scene, **DAMPED)
    blank = dict(arrays({"state.history": second.stepper.state.history}))
    poor = {name: np.zeros_like(value) for name, value in blank.items()}
    restore(second, halted("columns", scene) | poor)
    assert (finished(second).rate[-1] != whole("columns", scene).rate[-1]).any()


@pytest.mark.parametrize(
    "scene", [SOON, pytest.param(EARLY, marks=pytest.mark.slow)], ids=["soon", "early"]
)
def test_no_damping_is_the_limit_of_little(scene):
    """At the same step small damping changes the rates in proportion, and the limit is the run
    without damping."""
    step = Numerics(element_size=0.008, step=5e-7)
    rates = [
        highfi.run(tiny(**scene, **change), step).rate
        for change in (
            {},
            DAMPED | {"rail__damping__ratios": [1e-5, 1e-5]},
            DAMPED | {"rail__damping__ratios": [1e-4, 1e-4]},
        )
    ]
    little, more = (np.abs(rate - rates[0]).max() for rate in rates[1:])
    assert more / little == pytest.approx(10.0, rel=0.05)
