"""The accuracy limits of every reference run: both ledgers, momenta, step, friction; and that an
error in them would be found."""

import numpy as np
import pytest

from tests.highfi.support import COARSE, SOON, loop_on, replace_constants, tiny, whole
from tipoff import highfi
from tipoff.mechanics import ledger

EARLY = {"duration": "9 ms", "contact__clearance": "0.05 mm"}


@pytest.fixture(scope="module")
def result():
    return whole()


def test_run_exits_with_settled_rates(result):
    assert result.status == "exited"
    assert 0.0 < result.outcome.exit_time < result.time[-1]
    assert np.abs(result.outcome.rate).max() > 1e-3


def test_both_ledgers_close(result):
    assert result.checks["energy_error"] <= 1e-5
    assert result.checks["transverse_energy_error"] <= 1e-3


def test_momenta_and_quaternions_are_kept(result):
    assert result.checks["linear_momentum_error"] <= 1e-12
    assert result.checks["angular_momentum_error"] <= 1e-8
    assert result.checks["quaternion_error"] <= 1e-12


def test_friction_takes_energy_and_the_step_is_below_the_limit(result):
    assert result.checks["friction_power_max"] <= 0.0
    assert result.cost["dt_s"] <= result.cost["dt_limit_s"] * result.cost["safety"]


# Each set of effects is a kernel of its own, and compiling one takes longer than all runs here:
# most sets are slow tests.
@pytest.mark.parametrize(
    "change",
    [
        {"thrust__reaction": "exhaust"},
        pytest.param({"platform": None, "gravity__z": "-9.80665 m/s**2"}, marks=pytest.mark.slow),
        pytest.param({"platform": None}, marks=pytest.mark.slow),
        pytest.param({"friction": None}, marks=pytest.mark.slow),
        pytest.param({"gravity__y": "9.80665 m/s**2"}, marks=pytest.mark.slow),
        pytest.param({"contact": None, "friction": None}, marks=pytest.mark.slow),
    ],
)
def test_promises_hold_with_other_effects(change):
    early = {} if "contact" in change else {"contact__clearance": "0.05 mm"}
    found = highfi.run(tiny(duration="12 ms", **early, **change), COARSE)
    assert found.status == "time_limit"
    assert "contact" in change or np.abs(found.pad_force).max() > 0.0
    assert found.checks["energy_error"] <= 1e-5
    assert found.checks["transverse_energy_error"] <= 1e-3
    assert found.checks["linear_momentum_error"] <= 1e-12
    assert found.checks["angular_momentum_error"] <= 1e-8


def test_spurious_contact_energy_is_seen(result):
    """Contact that is stiffened by 1 % while pressed creates 1 % of its stored energy; the ledger
    must show that amount."""
    loop = loop_on(tiny(), highfi.prepare(tiny(), COARSE), COARSE)
    loop.begin()
    created = 0.0
    while created == 0.0:
        loop.advance_one_sample()
        stored = float(loop.stepper.state.load["stored"][0])
        if stored > 3e-6:
            created = 0.01 * stored
    system, stiffness = loop.setup.system, loop.setup.system.model.interface_stiffness
    model = system.model._replace(interface_stiffness=1.01 * stiffness)
    replace_constants(loop, system=system._replace(model=model))
    loop.integrate(None)
    found = loop.trajectory({}, COARSE)
    lost = found.checks["transverse_energy_error"] * loop.recorded.scale
    assert lost == pytest.approx(created, rel=0.2)
    assert found.checks["transverse_energy_error"] > 10.0 * result.checks["transverse_energy_error"]


@pytest.mark.parametrize(
    "relief, change",
    [
        ("flat", EARLY | {"duration": "14 ms"}),
        ("crowned", SOON),
        pytest.param("crowned", EARLY | {"duration": "14 ms"}, marks=pytest.mark.slow),
    ],
    ids=["flat", "crowned-soon", "crowned"],
)
def test_energy_of_sliding_pads_is_kept(relief, change):
    """Pads without a crown are pressed up to their edge, tilt and slide. No energy is released."""
    flat = [pad.model_dump() | {"relief": 0.0} for pad in tiny().pads]
    found = highfi.run(tiny(**change, **({"pads": flat} if relief == "flat" else {})), COARSE)
    assert np.abs(found.pad_force).max() > 100.0 and found.status == "time_limit"
    assert (found.energy[:, ledger.ENTRIES.index("released")] == 0.0).all()
    assert found.checks["transverse_energy_error"] <= 1e-4


def test_mirror_image(result):
    """Mirroring the scene in y mirrors the motion: rates are axial vectors, so x and z components
    change sign."""
    right = highfi.run(
        tiny(thrust_offset__misalignment__radial="165 deg", payload__inertia__xy="-0.004 kg*m**2"),
        COARSE,
    )
    mirrored = np.array(right.outcome.rate) * [-1.0, 1.0, -1.0]
    assert mirrored == pytest.approx(result.outcome.rate, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    "change", [SOON, pytest.param(EARLY, marks=pytest.mark.slow)], ids=["soon", "early"]
)
def test_same_input_same_bits(change):
    first, second = (highfi.run(tiny(**change), COARSE) for _ in range(2))
    assert np.abs(first.pad_force).max() > 0.0
    assert (first.velocity == second.velocity).all() and (first.energy == second.energy).all()


@pytest.mark.slow
def test_heavy_platform_is_a_fixed_one():
    """The recoil falls as 1/M: two masses show the rate at which the fixed platform is
    approached."""
    early = {"duration": "12 ms", "contact__clearance": "0.05 mm"}
    fixed = highfi.run(tiny(platform=None, **early), COARSE)
    assert np.abs(fixed.pad_force).max() > 0.0

    def difference(mass):
        scale = {f"platform__inertia__{axis}": 1e3 * mass for axis in ("xx", "yy", "zz")}
        free = highfi.run(tiny(platform__mass=mass, **scale, **early), COARSE)
        return np.abs(free.velocity - fixed.velocity).max()

    near, far = difference(1e6), difference(1e5)
    assert far / near == pytest.approx(10.0, rel=0.15)
