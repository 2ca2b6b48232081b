"""Whole ejections on eight pads: the symmetric one, promises, mirror image, and the plain rewrite
as oracle."""

import numpy as np
import pytest

from tests.lowfi.support import PAPER_PAD, corners, scene
from tipoff import lowfi
from tipoff.mechanics import ledger, momenta, promises
from tipoff.scenes import load
from validation import oracle

SHORT = {
    "start": -0.2,
    "end": 0.3,
    "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
}
CONDITIONS = [
    (name, condition)
    for name in ("clamped", "sensitive")
    for condition in ("phi0", "phi35", "phi60", "phi90")
]


@pytest.mark.case("X2")
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_zero_clearance_and_centred_thrust(tolerance):
    """Pads that just touch have no force under an axial push through the mass centre: J/m, no
    rates, no chatter."""
    push = {"kind": "constant", "force": 2000.0, "duration": 0.05}
    centred = scene(
        0.2, 1e-3, pads=corners(), rail=SHORT, contact=PAPER_PAD | {"clearance": 0.0}, thrust=push
    )
    numerics = lowfi.Numerics(relative_tolerance=tolerance)
    run = lowfi.run(centred, "springs", numerics=numerics)
    assert run.status == "exited" and run.cost["events"] == 0
    assert run.outcome.velocity == pytest.approx([5.0, 0.0, 0.0], rel=1e-9, abs=1e-9)
    assert np.abs(run.rate).max() <= 1e-9 and np.abs(run.velocity[:, 1:]).max() <= 1e-9
    assert (run.pad_force[0] == 0.0).all()
    # Control: the same test sees a sideways speed of a micrometre per second.
    nudged = lowfi.run(centred.replace({"initial.velocity.y": 1e-6}), "springs", numerics=numerics)
    assert (
        nudged.status == "exited"
        and np.abs(nudged.velocity[:, 1:]).max() > 1e-7
        and nudged.cost["events"] > 0
    )


@pytest.mark.parametrize("name, condition", CONDITIONS)
def test_promises(name, condition):
    """The checks of every result file, on both catalogue scenes."""
    run = lowfi.run(load(name).condition(condition), "springs")
    assert run.status == "exited"
    checks = run.checks
    assert checks["energy_error"] <= 1e-6 and checks["transverse_energy_error"] <= 1e-4
    assert checks["linear_momentum_error"] <= 1e-12 and checks["angular_momentum_error"] <= 1e-11
    assert checks["quaternion_error"] <= 1e-12
    assert checks["friction_power_max"] <= 0.0 and checks["damping_power_max"] <= 0.0
    assert 0.0 < run.cost["limit_used"] <= 1.0 + 1e-9
    assert run.pad_force.shape == (run.time.size, 16, 3) and (run.pad_force != 0.0).any()


def test_a_hundredth_of_spurious_contact_energy_is_seen():
    run = lowfi.run(load("sensitive").condition("phi60"), "springs")
    false = run.transverse_energy.copy()
    false[:, ledger.ENTRIES.index("contact_stored")] *= 1.01
    assert ledger.transverse_error(false) > 1e-4 > 10.0 * run.checks["transverse_energy_error"]


def test_a_lost_reaction_is_seen():
    """A force of 1 N for 1 us that has no opposite breaks the momentum balance."""
    values = np.zeros((3, 6))
    values[:, 0] = (60.0, 60.0, 60.0 + 1e-6)
    error, _ = momenta.errors(
        sums(10.0, (6.0, 0.0, 0.0), values, forces=np.full((3, 4, 3), 500.0)), promises.RIGID
    )
    assert error == pytest.approx(1e-6 / 60.0, rel=1e-3)


def test_a_sum_of_equal_impulses_may_round():
    """The impulse of a constant force in a hundred thousand steps: all of their roundings have one
    sign. The promise allows them, and no more."""
    steps, impulse = 100_000, 9.80665 * 1e-6
    summed = np.add.accumulate(np.full(steps, impulse))[steps // 4 - 1 :: steps // 4]
    exact = np.arange(1, 5) * (steps // 4) * impulse

    def error(momentum, steps):
        values, given = np.zeros((4, 6)), np.zeros((4, 6))
        values[:, 2], given[:, 2] = momentum, exact
        asked = sums(1.0, values[:, :3], values, given)
        return momenta.errors(asked, promises.FINITE_ELEMENTS, steps)[0]

    promised = promises.FINITE_ELEMENTS.linear_momentum_error
    assert error(summed, steps) <= promised < error(summed, 0)
    assert error(exact * (1.0 + 1e-10), steps) > promised  # control


def sums(mass, velocity, values, given=None, forces=None, weight=0.0) -> momenta.Sums:
    """Balance of one body without spin at the origin, at samples 1 ms apart."""
    samples = len(values)
    place = np.zeros((samples, 3))
    given = np.zeros((samples, 6)) if given is None else given
    forces = np.zeros((samples, 1, 3)) if forces is None else forces
    moving = np.broadcast_to(velocity, (samples, 3))
    return momenta.Sums(
        values=values,
        given=given,
        sizes=momenta.of_bodies([(mass, place, moving, place)]),
        impulses=momenta.impulses(np.arange(samples) * 1e-3, given, forces, weight),
        reach=0.0,
    )


@pytest.mark.parametrize(
    "name, condition", [("clamped", "phi15"), ("clamped", "phi35"), ("sensitive", "phi60")]
)
def test_agrees_with_the_plain_rewrite(name, condition):
    """Newton and Euler with fixed steps of 5 us, against the fast path at two tolerances."""
    asked = load(name).condition(condition)
    plain = oracle.solve(asked, 10)
    for tolerance, error in ((2e-7, 1e-4), (1e-9, 5e-6)):
        run = lowfi.run(asked, "springs", numerics=lowfi.Numerics(relative_tolerance=tolerance))
        same = slice(0, run.time.size)
        assert np.abs(run.rate - plain.rate[same]).max() <= error * np.abs(run.rate).max()
        assert (
            np.abs(run.velocity - plain.velocity[same]).max()
            <= error * np.abs(run.velocity[:, 1:]).max()
        )
    # Control: at 1 ms per step, which the thrust alone would allow, the same plain method misses
    # the impacts.
    coarse, count = (
        oracle.solve(asked.replace({"output.interval": 1e-3}), 1).rate,
        run.time.size // 20,
    )
    assert (
        not np.abs(coarse[:count] - run.rate[::20][:count]).max() <= 1e-2 * np.abs(run.rate).max()
    )


def test_settled_rate_is_converged():
    """At most 0.1 % from a tolerance a thousand times finer, and orders of magnitude closer in
    between."""
    asked, errors = load("sensitive").condition("phi35"), []
    fine = np.array(
        lowfi.run(asked, "springs", numerics=lowfi.Numerics(relative_tolerance=2e-10)).outcome.rate
    )
    for tolerance in (2e-5, 2e-7, 2e-9):
        found = lowfi.run(
            asked, "springs", numerics=lowfi.Numerics(relative_tolerance=tolerance)
        ).outcome.rate
        errors.append(np.abs(found - fine).max() / np.abs(fine).max())
    assert errors[1] <= 1e-3 and errors[2] < 0.1 * errors[1] and errors[1] < 0.1 * errors[0]


def test_mirror_image():
    """y to -y reverses roll and yaw and leaves pitch, for any order of the pads."""
    asked = load("sensitive").condition("phi35")
    mirror = asked.replace(
        {
            "thrust_offset.misalignment.radial": "145 deg",
            "payload.inertia.xy": -asked.payload.inertia.xy,
        }
    )
    one, other = lowfi.run(asked, "springs"), lowfi.run(mirror, "springs")
    scale = np.abs(one.outcome.rate).max()
    assert np.array(other.outcome.rate) * (-1.0, 1.0, -1.0) == pytest.approx(
        np.array(one.outcome.rate), abs=1e-6 * scale
    )
    assert np.array(other.outcome.velocity) * (1.0, -1.0, 1.0) == pytest.approx(
        np.array(one.outcome.velocity), abs=1e-8
    )
