"""O61, O62: springs push a payload of either solver, against closed forms and a plain integration."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

import tests.pushed
from tests.exact.spring import end_of_stroke
from tests.highfi.support import COARSE, IMMOVABLE
from tests.lowfi.support import numerics
from tests.pushed import (
    MASSES,
    PUSHER,
    SPRING,
    TILTS,
    UNEQUAL,
    check_share_of_a_pusher,
    flown,
    heavy_and_tilted,
    springs,
)
from tipoff import highfi, lowfi
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import scene_model

MASS = 9.9
INERTIA = {"xx": 0.066, "yy": 0.134, "zz": 0.128, "xy": 0.004, "xz": -0.002}
LIGHT = {"mass": 20.0, "inertia": {"xx": 1.0, "yy": 1.0, "zz": 1.0}}


class Solver(NamedTuple):
    """A solver, and the relative errors that it may have."""

    run: Callable[..., Trajectory]
    speed: float  # of the payload behind one spring
    pusher: float  # the same with a heavy pusher
    velocity: float  # behind several springs
    rate: float
    recoil: float  # of the platform; in the finite elements of its rigid part
    friction: float  # of the energy that friction takes


SOLVERS = {
    "surrogate": Solver(
        lambda scene: lowfi.run(scene, "springs", numerics=numerics(1e-10)),
        speed=1e-8,
        pusher=1e-9,
        velocity=1e-9,
        rate=1e-7,
        recoil=1e-8,
        friction=1e-7,
    ),
    # rails that the platform carries vibrate with 1e-7 of the energy
    "finite elements": Solver(
        lambda scene: highfi.run(scene, COARSE),
        speed=2e-7,
        pusher=1e-6,
        velocity=2e-7,
        rate=1e-6,
        recoil=1e-4,
        friction=1e-6,
    ),
}
EACH = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
PLATFORMS = pytest.mark.parametrize("platform", [IMMOVABLE, LIGHT], ids=["fixed", "free"])


def pushed(thrust: dict, duration: float, platform: dict = IMMOVABLE):
    """``tests.pushed.pushed`` with the mass and inertia of the closed forms."""
    heavy = {"payload__mass": MASS, "payload__inertia": INERTIA}
    return tests.pushed.pushed(thrust, duration, platform, **heavy)


@pytest.mark.case("O61")
@EACH
@PLATFORMS
@pytest.mark.parametrize("friction", [0.0, 3000.0])
def test_the_speed_follows_from_the_energy(solver, platform, friction):
    """With and without friction of the pusher, and of the recoil of a light platform, wherever in a
    step the stroke ends. Friction fades below 1 mm/s, where the payload gains 1e-8 of its energy."""
    numbers = (2e4, 2e5, 0.02)
    exact = end_of_stroke(*numbers, (MASS, platform["mass"]), friction)
    run = solver.run(pushed(SPRING | {"friction": friction}, exact.time + 5e-4, platform))
    assert run.status == "time_limit", run.message
    assert run.velocity[-1, 0] == pytest.approx(exact.payload, rel=solver.speed)
    recoil = run.platform_velocity[-1, 0]
    assert recoil == pytest.approx(exact.platform, rel=solver.recoil, abs=1e-12)
    assert run.checks["linear_momentum_error"] < 1e-12
    assert run.energy[-1, 0] == pytest.approx(2e4 * 0.02 - 1e5 * 0.02**2, rel=1e-10)
    assert run.energy[-1, 6] == pytest.approx(friction * 0.02, rel=solver.friction)
    assert run.checks["energy_error"] < 1e-7
    # Control: the same force over time on a platform that does not move.
    fixed = end_of_stroke(*numbers, (MASS, np.inf), friction)
    assert platform is IMMOVABLE or abs(fixed.payload / exact.payload - 1.0) > 0.1


def test_central_differences_need_a_rule_for_the_end_of_the_stroke():
    """With it the finite elements have a tenth of the error that plain central differences of their step
    have, with ends of the stroke at ten places in a step."""
    exact = end_of_stroke(2e4, 2e5, 0.02, (MASS, np.inf))
    run = highfi.run(pushed(SPRING, exact.time + 5e-4), COARSE)
    step, worst = run.cost["dt_s"], 0.0
    for share in np.linspace(0.0, 1.0, 10):
        time = -share * step
        s = 0.5 * 2e4 / MASS * time**2
        v = 2e4 / MASS * (time - 0.5 * step)
        while s < 0.02:
            v += step * (2e4 - 2e5 * s) / MASS
            s += step * v
        worst = max(worst, abs(v / exact.payload - 1.0))
    assert worst > 1e-6 > 5.0 * abs(run.velocity[-1, 0] / exact.payload - 1.0)


@pytest.mark.case("O61")
@EACH
@PLATFORMS
def test_a_pusher_keeps_its_share_of_the_energy(solver, platform):
    """A pusher of 0.5 kg goes with the payload to the end of the stroke, and its kinetic energy stays
    behind. Both momenta are kept. Control: without its mass the payload is 2 % faster."""
    exact = end_of_stroke(2e4, 2e5, 0.02, (MASS, platform["mass"]), 0.0, PUSHER)
    run = solver.run(pushed(SPRING | {"mass": PUSHER}, exact.time + 5e-4, platform))
    payload, recoil = run.velocity[-1, 0], run.platform_velocity[-1, 0]
    assert payload == pytest.approx(exact.payload, rel=solver.pusher)
    assert recoil == pytest.approx(exact.platform, rel=solver.recoil, abs=1e-12)
    check_share_of_a_pusher(run, MASS, platform["mass"])


y, z = np.mean(UNEQUAL, axis=0)[3:]
# Springs with unequal forces, rates, strokes and places; with unequal masses and directions too. What they
# have beside the places, the controls, and by how much these differ.
JOINED = {"numbers": [(*row[:3], y, z) for row in UNEQUAL]}
UNLIKE = {
    "places": (springs(), {}, [JOINED], 0.1),
    "masses and tilts": (
        heavy_and_tilted(),
        {"masses": MASSES, "tilts": TILTS},
        [{"tilts": TILTS}, {"masses": MASSES}],
        0.01,
    ),
}


@pytest.mark.case("O62")
@EACH
@pytest.mark.parametrize("unlike", UNLIKE)
def test_unequal_springs_turn_a_free_payload(solver, unlike):
    """Rates and velocity after the last stroke, against a plain integration. Control: springs at the mean
    place of their lines, without the masses, or without the tilts turn it otherwise."""
    thrust, exactly, others, apart = UNLIKE[unlike]
    body = scene_model.build(pushed(thrust, 0.01)).payload
    exact = flown(body.mass, body.inertia, **exactly)
    assert np.abs(exact.rate).min() > 0.01
    run = solver.run(pushed(thrust, exact.time))
    np.testing.assert_allclose(run.rate[-1], exact.rate, rtol=solver.rate)
    np.testing.assert_allclose(run.velocity[-1], exact.velocity, rtol=solver.velocity, atol=1e-9)
    # Control:
    for other in others:
        turned = flown(body.mass, body.inertia, **other).rate
        assert np.abs(turned / exact.rate - 1.0).max() > apart
