"""Rails that rest: against runs that step everything, and the controls that fail.

The early scene has a small clearance, so that pads touch some of the rails within milliseconds, and
leaves out the others.
"""

import functools
from dataclasses import replace

import numpy as np
import pytest

from tests.highfi.support import COARSE, parts, tiny
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics import jolts, observe, resting, waking
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.simulation import Loop
from tipoff.kernels import rotation
from tipoff.mechanics.ledger import ENTRIES
from tipoff.results.trajectory import Trajectory

FINE = Numerics(element_size=0.004)
EARLY = {
    "duration": "9 ms",
    "contact__clearance": "0.05 mm",
    "thrust_offset__misalignment__radial": "0 deg",
}


# The thrust of the scene ``reference``: that of ``tiny`` starts so fast that rails of a free platform
# cannot rest.
SLOW = {"thrust__peak": "6 kN", "thrust__width": "4 ms", "thrust__centre": "12 ms"}


@pytest.fixture(params=[COARSE, pytest.param(FINE, marks=pytest.mark.slow)], ids=["coarse", "fine"])
def numerics(request) -> Numerics:
    """Those of two extruded meshes: their rails rest one by one."""
    return request.param


def loop_of(scene, numerics=FINE, rests=True, **changes) -> Loop:
    """A loop that has begun, whose ``Rails`` have ``changes``."""
    system, stepping, found = parts(scene, numerics)
    rails = found if rests else None
    loop = Loop(set_up(scene, system, stepping, 1, rails and rails._replace(**changes)))
    loop.begin()
    return loop


def run_out(loop: Loop) -> Loop:
    """The loop at its end."""
    loop.integrate(None)
    assert not loop.recorded.message
    return loop


def rows(loop: Loop) -> np.ndarray:
    """Motion of the bodies at the samples."""
    return np.array(loop.recorded.rows)[:, : observe.KINETIC]


@functools.cache
def fixed(numerics: Numerics, rests: bool) -> Loop:
    """The early scene on a fixed platform, without long steps, so that nothing differs but rest."""
    changes = {"stride": 1} if rests else {}
    return run_out(loop_of(tiny(platform=None, **EARLY), numerics, rests, **changes))


@functools.cache
def free(rests: bool) -> Trajectory:
    """A slow scene on a free platform, whose settled rates come from impacts."""
    numerics = Numerics(element_size=COARSE.element_size, step_everything=not rests)
    return highfi.run(tiny(duration="58 ms", **SLOW), numerics)


def test_on_a_fixed_platform_rest_changes_no_bit(numerics):
    """Some rails are touched and woken, others never."""
    one, other = fixed(numerics, True), fixed(numerics, False)
    assert np.abs(one.recorded.forces).max() > 1.0 and 0 < one.stepper.rests.sum() < 4
    np.testing.assert_array_equal(rows(one), rows(other))
    np.testing.assert_array_equal(one.recorded.forces, other.recorded.forces)
    np.testing.assert_array_equal(one.stepper.state.displacement, other.stepper.state.displacement)
    assert one.stepper.jolts.most[0] == 0.0
    assert 0.0 < one.recorded.cost(one.stepper)["stepped_share"] < 0.9


@pytest.mark.parametrize("ahead", [0.0, 0.7, 1.4, 2.1])
def test_a_rail_is_stepped_before_a_fast_pad_arrives(numerics, ahead):
    """At 8 m/s pads need the two steps in which they may come at 10 m/s, wherever between two looks
    they are. No bit changes."""
    scene = tiny(
        platform=None,
        contact__clearance="0.02 mm",
        duration="4 us",
        output__interval="1 us",
        initial={"velocity": {"y": 8.0}, "position": {"y": 1e-6 * ahead}},
    )
    one, other = (loop_of(scene, numerics, rests) for rests in (True, False))
    assert one.stepper.rests.all()
    for loop in (one, other):
        loop.integrate(None)
    assert np.abs(one.recorded.forces).max() > 1.0 and not one.stepper.rests.all()
    np.testing.assert_array_equal(rows(one), rows(other))
    np.testing.assert_array_equal(one.recorded.forces, other.recorded.forces)


def test_waking_too_late_is_seen(numerics):
    """Control: a rail that no pad wakes gives another motion, or none, since contact does not act
    on it."""
    system = fixed(numerics, True).setup.system
    none = np.zeros((4, system.surface.groups.first_face.size - 1), dtype=bool)
    late = loop_of(tiny(platform=None, **EARLY), numerics, stride=1, groups=none)
    late.integrate(None)
    found, expected = rows(late), rows(fixed(numerics, False))[: len(late.recorded.rows)]
    assert late.stepper.rests.all() and np.abs(found - expected)[:, observe.RATE].max() > 1e-4


@pytest.mark.parametrize("duration", ["3 ms", pytest.param("9 ms", marks=pytest.mark.slow)])
def test_long_steps_change_less_than_the_scheme_errs(duration):
    """Several steps at once while no pad is near: order two, so the velocity along the thrust has an
    error of a millionth."""
    scene = tiny(platform=None, duration=duration)
    long, short = run_out(loop_of(scene)), run_out(loop_of(scene, rests=False))
    assert long.recorded.parts < 0.8 * long.stepper.steps and long.stepper.rests.all()
    assert_near(long, short)


def test_long_steps_end_before_a_pad_is_near(numerics):
    """Single steps from then on, through the contact: the motion is as near as before it."""
    scene = tiny(platform=None, **EARLY | {"contact__clearance": "0.12 mm"})
    long, short = (run_out(loop_of(scene, numerics, rests)) for rests in (True, False))
    assert 0.3 * long.stepper.steps < long.recorded.parts < 0.8 * long.stepper.steps
    assert np.abs(long.recorded.forces).max() > 1.0 and not long.stepper.rests.all()
    assert_near(long, short)


def assert_near(long: Loop, short: Loop) -> None:
    """Motion of the bodies within 1e-5 of its largest values."""
    found, expected = rows(long), rows(short)
    for first, size in ((observe.POSITION, 3), (observe.VELOCITY, 3), (observe.RATE, 3)):
        part = slice(first, first + size)
        scale = np.abs(expected[:, part]).max()
        assert np.abs(found[:, part] - expected[:, part]).max() < 1e-5 * scale


def test_on_a_free_platform_the_error_is_bounded():
    """Rest changes the settled rates by less than 1e-5 of them, and what it left out is known."""
    one, other = free(True), free(False)
    scale = np.abs(other.outcome.rate).max()
    assert 0.0 < np.abs(np.subtract(one.outcome.rate, other.outcome.rate)).max() < 1e-5 * scale
    assert 0.0 < one.cost["left_out_m"] < 10.0 * resting.MOST_LEFT_OUT
    assert one.cost["steps_taken"] < one.cost["steps"] and one.cost["stepped_share"] < 0.9
    every, stepped = (
        run.cost["ns_per_element_stepped"] / run.cost["ns_per_element_step"] for run in (other, one)
    )
    assert every == pytest.approx(1.0) and stepped > 1.1  # elements at rest take no time
    assert other.cost["steps_taken"] == other.cost["steps"] and other.cost["left_out_m"] == 0.0


def test_ledgers_and_momenta_hold_where_rails_rest():
    """The rest after the exit releases the energy of their vibration, and no other entry."""
    one, other = free(True), free(False)
    assert one.checks["linear_momentum_error"] < 1e-14
    assert one.checks["angular_momentum_error"] < 1e-11
    assert one.checks["energy_error"] < 1e-8
    assert one.checks["transverse_energy_error"] < 1e-4
    released, strain = ENTRIES.index("released"), ENTRIES.index("strain")
    assert one.energy[-1, released] > 1e-7 and not other.energy[:, released].any()
    assert one.energy[-1, strain] == 0.0 < other.energy[-1, strain]


def shaken(numerics: Numerics) -> Loop:
    """The early scene on a free platform, at a sample with vibrating rails and no contact."""
    loop = loop_of(tiny(**SLOW), numerics)
    while loop.stepper.rests.all() or loop.stepper.active.node_count.any():
        loop.advance_one_sample()
    loop.stepper.set_stride(1)
    return loop


def sampled(loop: Loop) -> np.ndarray:
    """The sample vector of the present state."""
    return loop.stepper.sample()


def centre_of(loop: Loop) -> np.ndarray:
    """Mass centre of platform and rails (m)."""
    now, state = loop.stepper.now, loop.stepper.state
    base = rotation.matrices(state.platform.quaternion[None])[0]
    origin = state.platform.position - base @ now.frame.centre
    rails = now.moving_mass @ (now.rail.points + state.displacement)
    rigid = now.frame.mass * state.platform.position
    whole = rigid + now.moving_mass.sum() * origin + base @ rails
    return whole / now.frame.total_mass


def test_momentum_and_energy_of_the_whole_when_rails_are_laid_to_rest(numerics):
    """At the instant itself, to rounding. Control: without the energy that is entered as released
    the balance is off."""
    loop = shaken(numerics)
    centre = centre_of(loop)
    spent, before = loop.stepper.state.work["released"][0], sampled(loop)
    waking.let_rest(loop.setup.rails, loop.stepper, np.ones_like(loop.stepper.rests))
    after = sampled(loop)
    # The momentum of the whole is near zero; that of the payload is not.
    scale = loop.setup.system.model.payload.mass * np.abs(before[observe.VELOCITY])
    momenta = slice(observe.LINEAR, observe.ANGULAR + 3)
    np.testing.assert_allclose(after[momenta], before[momenta], rtol=0.0, atol=1e-13 * scale)
    np.testing.assert_allclose(centre_of(loop), centre, rtol=0.0, atol=1e-16)
    lost = before[[observe.KINETIC, observe.STRAIN]].sum() - after[observe.KINETIC]
    released = loop.stepper.state.work["released"][0] - spent
    assert after[observe.STRAIN] == 0.0 < before[observe.STRAIN]
    assert released == pytest.approx(lost, rel=1e-2) and released > 0.5 * before[observe.STRAIN]


def deflected(loop: Loop) -> np.ndarray:
    """Static deflection (n,3) m of all rails under the present acceleration of their mounts."""
    now, state = loop.stepper.now, loop.stepper.state
    before, after = (jolts.rates(now, state, moving) for moving in loop.stepper.moving())
    terms = jolts.terms(loop.setup.system, before, after, loop.stepper.step)
    found = np.zeros_like(state.displacement)
    for solids in loop.setup.rails.deflections:
        for solid in solids:
            found[loop.setup.system.number[solid.own]] = solid.under(terms)
    return found


def test_a_rail_that_is_woken_has_its_static_deflection(numerics):
    """At every sample it differs from the displacement of a rail that was stepped from ignition by
    less than what is said to be left out. Control: a straight rail would be off by more than that."""
    scene = tiny(duration="9 ms", **SLOW)
    one, other = (loop_of(scene, numerics, rests) for rests in (True, False))
    while len(one.recorded.rows) <= 80:
        one.advance_one_sample()
        other.advance_one_sample()
        moved, static = other.stepper.state.displacement, deflected(one)
        assert (
            one.stepper.rests.all()
            and np.abs(static - moved).max() < one.stepper.jolts.left_out[0] < 1e-9
        )
    assert np.abs(moved).max() > 2.0 * one.stepper.jolts.left_out[0]
    waking.let_rest(one.setup.rails, one.stepper, np.zeros_like(one.stepper.rests))
    np.testing.assert_allclose(one.stepper.state.displacement, static, rtol=0.0, atol=1e-18)


def test_a_jump_of_the_thrust_wakes_rails_of_a_free_platform_before_it(numerics):
    """The rails would swing by the whole static deflection. Until then they rest."""
    loop = loop_of(tiny(**EARLY, thrust__cutoff=1.5), numerics)
    jump = loop.setup.rails.jumps[0]
    while loop.stepper.rests.any():
        assert loop.stepper.time < jump
        loop.advance_one_sample()
    assert jump - loop.stepper.time < 2.0 * loop.setup.scene.output.interval


def test_a_strong_start_is_stepped_from_ignition(numerics):
    """Control: under the smooth thrust of the scene rails rest at ignition."""
    assert loop_of(tiny(**SLOW), numerics).stepper.rests.all()
    assert not loop_of(tiny(**SLOW | {"thrust__centre": "0 ms"}), numerics).stepper.rests.any()


def test_warm_rails_rest_as_they_were_heated(numerics):
    """Temperature bends a rail before ignition; it rests in that shape. No bit changes until the
    payload has left."""
    warm = {"thermal__mean": "20 K", "thermal__gradient__y": "500 K/m", "platform": None} | EARLY
    one = run_out(loop_of(tiny(**warm), numerics, stride=1))
    other = run_out(loop_of(tiny(**warm), numerics, rests=False))
    assert one.setup.system.warm is not None and np.abs(one.setup.system.warm).max() > 1e-6
    np.testing.assert_array_equal(rows(one), rows(other))


@pytest.mark.slow  # a kernel to compile
def test_the_weight_of_rails():
    """On a fixed platform the sudden weight swings the rails, so they are stepped from ignition. A
    free platform falls with them, and they rest."""
    weight = {"gravity__z": "-9.81 m/s**2"} | SLOW
    assert not loop_of(tiny(platform=None, **weight)).stepper.rests.any()
    assert loop_of(tiny(**weight)).stepper.rests.all()


def test_step_everything_is_the_loop_without_rest(numerics):
    """The switch gives the bits of a loop that knows no rest."""
    asked = replace(numerics, step_everything=True)
    found = highfi.run(tiny(platform=None, **EARLY), asked)
    assert found.cost["stepped_share"] == 1.0
    expected = fixed(numerics, False).trajectory({}, asked)
    np.testing.assert_array_equal(found.rate, expected.rate)
    np.testing.assert_array_equal(found.energy, expected.energy)


def test_build_gives_up_where_a_rail_is_too_large(monkeypatch, numerics):
    """Its factor would not fit in memory, so everything is stepped; a fixed platform needs none."""
    monkeypatch.setattr(resting, "MOST_NODES", 10)
    for platform, expected in (({}, type(None)), ({"platform": None}, Rails)):
        scene = tiny(**EARLY, **platform)
        system = build(scene, numerics, highfi.prepare(scene, numerics))
        found = resting.build(scene, system, choose(system, scene, numerics))
        assert isinstance(found, expected)
