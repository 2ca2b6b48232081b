"""O61, O62: springs push a payload of the reference, against closed forms and a plain integration."""

import numpy as np
import pytest

from tests.exact.spring import end_of_stroke
from tests.highfi.support import CENTRED, COARSE, IMMOVABLE, parts, tiny
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
from tipoff import highfi
from tipoff.highfi.dynamics.step_limit import of_pushers
from tipoff.scenes import scene_model

LIGHT = {"mass": 20.0, "inertia": {"xx": 1.0, "yy": 1.0, "zz": 1.0}}
MASS = 9.9


def pushed(thrust: dict, duration: float, platform: dict = IMMOVABLE):
    """A payload without contact that springs push from a platform; by default it does not move."""
    return tiny(
        duration=duration,
        output={"interval": duration / 5},
        contact=None,
        friction=None,
        platform=platform,
        thrust_offset=CENTRED,
        thrust=thrust,
    )


@pytest.mark.case("O61")
@pytest.mark.parametrize("friction, platform", [(0.0, LIGHT), (3000.0, LIGHT), (3000.0, IMMOVABLE)])
def test_the_speed_follows_from_the_energy(friction, platform):
    """With and without friction of the pusher, and of the recoil of a light platform, wherever in a
    step the stroke ends. The rails of the platform vibrate with 1e-7 of the energy."""
    masses = (MASS, platform["mass"])
    exact = end_of_stroke(2e4, 2e5, 0.02, masses, friction)
    asked = pushed(SPRING | {"friction": friction}, exact.time + 5e-4, platform)
    run = highfi.run(asked, COARSE)
    assert run.status == "time_limit", run.message
    assert run.velocity[-1, 0] == pytest.approx(exact.payload, rel=2e-7)
    # of its rigid part
    assert run.platform_velocity[-1, 0] == pytest.approx(exact.platform, rel=1e-4, abs=1e-12)
    assert run.checks["linear_momentum_error"] < 1e-12
    energy = 2e4 * 0.02 - 1e5 * 0.02**2
    assert run.energy[-1, 0] == pytest.approx(energy, rel=1e-12)
    assert run.energy[-1, 6] == pytest.approx(friction * 0.02, rel=1e-6)
    assert run.checks["energy_error"] < 1e-7
    # Control: the same force over time on a platform that does not move.
    fixed = end_of_stroke(2e4, 2e5, 0.02, (MASS, np.inf), friction)
    assert platform is IMMOVABLE or abs(fixed.payload / exact.payload - 1.0) > 0.1
    # Control: central differences without a rule for the step in which the stroke ends.
    assert worst_without_a_rule(run.cost["dt_s"]) > 1e-6


def worst_without_a_rule(step: float) -> float:
    """Largest relative error of the speed by plain central differences of this step (s), for ends
    of the stroke at ten places in a step."""
    worst, exact = 0.0, end_of_stroke(2e4, 2e5, 0.02, (MASS, np.inf)).payload
    for share in np.linspace(0.0, 1.0, 10):
        time = -share * step
        s = 0.5 * 2e4 / MASS * time**2
        v = 2e4 / MASS * (time - 0.5 * step)
        while s < 0.02:
            v += step * (2e4 - 2e5 * s) / MASS
            s += step * v
        worst = max(worst, abs(v / exact - 1.0))
    return worst


@pytest.mark.case("O62")
def test_unequal_springs_turn_a_free_payload():
    """Four springs with other forces, rates, strokes and places: rates and velocity after the last
    stroke, against a plain integration."""
    body = scene_model.build(pushed(springs(), 0.01)).payload
    exact = flown(body.mass, body.inertia)
    run = highfi.run(pushed(springs(), exact.time), COARSE)
    np.testing.assert_allclose(run.rate[-1], exact.rate, rtol=1e-6)
    np.testing.assert_allclose(run.velocity[-1], exact.velocity, rtol=3e-7, atol=1e-9)
    # Control: all springs at the mean place of their lines turn it otherwise.
    y, z = np.mean(UNEQUAL, axis=0)[3:]
    joined = flown(body.mass, body.inertia, [(*row[:3], y, z) for row in UNEQUAL])
    assert np.abs(joined.rate / exact.rate - 1.0).max() > 0.1


@pytest.mark.case("O61")
@pytest.mark.parametrize("platform", [IMMOVABLE, LIGHT])
def test_a_pusher_keeps_its_share_of_the_energy(platform):
    """A pusher of 0.5 kg goes with the payload to the end of the stroke, and its kinetic energy stays
    behind. Both momenta are kept. Control: without its mass the payload is 2 % faster."""
    exact = end_of_stroke(2e4, 2e5, 0.02, (MASS, platform["mass"]), 0.0, PUSHER)
    asked = pushed(SPRING | {"mass": PUSHER}, exact.time + 5e-4, platform)
    run = highfi.run(asked, COARSE)
    payload, recoil = run.velocity[-1, 0], run.platform_velocity[-1, 0]
    assert payload == pytest.approx(exact.payload, rel=1e-6)
    assert recoil == pytest.approx(exact.platform, rel=1e-4, abs=1e-12)
    check_share_of_a_pusher(run, MASS, platform["mass"])


@pytest.mark.case("O62")
def test_heavy_and_tilted_pushers_turn_a_free_payload():
    """Four springs with unequal masses and directions too, against a plain integration. Control: without
    the masses, or without the tilts, the rates differ by more than 1 %."""
    body = scene_model.build(pushed(heavy_and_tilted(), 0.01)).payload
    exact = flown(body.mass, body.inertia, masses=MASSES, tilts=TILTS)
    run = highfi.run(pushed(heavy_and_tilted(), exact.time), COARSE)
    np.testing.assert_allclose(run.rate[-1], exact.rate, rtol=2e-6)
    np.testing.assert_allclose(run.velocity[-1], exact.velocity, rtol=1e-6, atol=1e-9)
    # Control:
    for other in ({"tilts": TILTS}, {"masses": MASSES}):
        apart = flown(body.mass, body.inertia, **other).rate / exact.rate - 1.0
        assert np.abs(apart).max() > 0.01


def test_the_step_limit_includes_the_springs():
    """The bound is not below the largest eigenvalue of springs on a rigid payload, nor twice it for
    one spring; and the limit of a run falls with it."""
    asked = pushed(SPRING | {"friction": 1000.0}, 0.01)
    system, stepping, _ = parts(asked)
    body, point = system.model.payload, np.array([-0.1, 0.0, 0.0])
    lever = np.cross(point, [1.0, 0.0, 0.0])
    exact = 2e5 * (1.0 / body.mass + lever @ body.inverse_inertia @ lever)
    bound = of_pushers(system)
    assert exact <= bound.stiffness <= 2e5 * (1.0 / body.mass + 0.01 / 0.06)
    assert bound.damping == pytest.approx(bound.stiffness * 1000.0 / 2e5 / 1e-3, rel=1e-12)
    _, stiffer, _ = parts(pushed(SPRING | {"preload": 1e15, "rate": 1e15}, 0.01))
    assert stiffer.dt_limit_s < 0.5 * stepping.dt_limit_s


def test_a_run_continues_to_the_same_bits(tmp_path):
    """The segments, travels and forces of the pushers are in a checkpoint."""
    asked, kept = pushed(springs(), 0.006), tmp_path / "run.npz"
    whole = highfi.run(asked, COARSE)
    interrupted = {"count": 0}

    def stop(loop):
        interrupted["count"] += 1
        if interrupted["count"] == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        highfi.run(asked, COARSE, checkpoint=kept, checkpoint_every=0.0, observer=stop)
    resumed = highfi.run(asked, COARSE, checkpoint=kept, resume=True)
    np.testing.assert_array_equal(resumed.rate, whole.rate)
    np.testing.assert_array_equal(resumed.energy, whole.energy)
