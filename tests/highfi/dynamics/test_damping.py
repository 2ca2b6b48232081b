"""Structural damping in the full time loop: how fast modes of a bar decay, and its effect on frame,
ledgers, bits and code."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import block, free_stiffness, highest_mode, modes
from tests.highfi.support import NEUTRAL, loop_on, replace_constants
from tipoff.highfi.dynamics.step_limit import step_limit, used
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.simulation import Loop
from tipoff.highfi.statics import stable_step
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.scenes import parse

LENGTH, WIDTH, CYCLES = 0.06, 0.02, 20
TWO_STEPS = pytest.mark.parametrize("safety", [0.9, 0.45])


def bar(elements):
    """Bar of the 7075 alloy along X, clamped at its root, one surface that nothing touches."""
    mesh = block((elements, 1, 1), (LENGTH, WIDTH, WIDTH))
    mesh.surfaces["contact_y"] = mesh.surfaces["mount"]
    return mesh


def scene(damping=None, **tables):
    """A rail alone: nothing touches it, no thrust, nothing moves but what a test moves."""
    rail = {
        "start": 0.0,
        "end": LENGTH,
        "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
    }
    return parse(
        NEUTRAL
        | {
            "name": "bar",
            "duration": 1.0,
            "output": {"interval": 1e-3},
            "pads": [{"position": [0.0, 5.0, 0.0], "normals": ["+y"]}],
            "payload": {"mass": 1.0, "inertia": {"xx": 1.0, "yy": 1.0, "zz": 1.0}},
            "rail": rail | ({"damping": damping} if damping else {}),
        }
        | tables,
        bare_numbers_are_si=True,
    )


class Ringing:
    """A mode of the bar, let go from rest, in the product's own loop; ``shape`` (n,3) has unit
    modal mass."""

    def __init__(self, loop: Loop, frequency: float, shape: np.ndarray):
        self.loop, self.frequency = loop, frequency
        number, state = loop.setup.system.number, loop.stepper.state
        self.weight = np.zeros(state.displacement.shape)
        self.weight[number] = loop.setup.system.operator.mass[:, None] * shape
        state.displacement[number] = 1e-6 * shape
        loop.begin()

    def amplitude(self, ratio: float) -> float:
        """Modal amplitude that coordinate and velocity belong to, were the mode damped by
        ``ratio``; exp(-ratio w t) then.

        Central differences turn a mode by 2 asin(w dt / 2) a step, so w stands for its sine over
        the step.
        """
        state, step = self.loop.stepper.state, self.loop.setup.stepping.dt_s
        before, w = state.velocity.copy(), 2.0 * math.pi * self.frequency
        self.loop.stepper.kick(step)
        q, v = (
            float((self.weight * part).sum())
            for part in (state.displacement, 0.5 * (before + state.velocity))
        )
        state.velocity[:] = before
        return math.hypot(
            q,
            (v + ratio * w * q)
            * step
            / (math.sin(2.0 * math.asin(0.5 * w * step)) * math.sqrt(1.0 - ratio**2)),
        )

    def decay(self, ratio: float, cycles: float) -> float:
        """Amplitude after so many damped cycles over that at the start."""
        start, time = self.amplitude(ratio), cycles / (self.frequency * math.sqrt(1.0 - ratio**2))
        count = round(time / self.loop.setup.stepping.dt_s)
        self.loop.advance_steps(count)
        late = count * self.loop.setup.stepping.dt_s - time
        return (
            self.amplitude(ratio) / start * math.exp(2.0 * math.pi * ratio * self.frequency * late)
        )


def damping(frequencies, ratios=(0.01, 0.01)):
    return {"frequencies": list(frequencies), "ratios": list(ratios)}


def changed(loop: Loop, **values) -> Loop:
    """``loop`` with other damping constants but the same step."""
    rail = loop.setup.system.rail
    rail = rail._replace(damping=rail.damping._replace(**values))
    replace_constants(loop, system=loop.setup.system._replace(rail=rail))
    return loop


@pytest.fixture(scope="module")
def found():
    """First bending mode, and the first axial one well above it: frequencies (Hz) and shapes."""
    operator = loop_on(scene(), bar(6)).setup.system.operator
    frequencies, shapes = modes(operator, 8)
    axial = next(
        i for i in range(8) if np.abs(shapes[i, :, 0].mean()) > 0.5 * np.abs(shapes[i]).max()
    )
    return [(frequencies[0], shapes[0]), (frequencies[axial], shapes[axial])]


@pytest.mark.case("O17")
@TWO_STEPS
@pytest.mark.parametrize("mode", [0, 1])
def test_modes_decay_as_stated_at_both_frequencies(found, mode, safety):
    """exp(-2 pi z n / sqrt(1 - z2)) = 0.284592 at z = 0.01, n = 20. Control: with beta K alone both
    modes decay too slowly."""
    exact = elasticity.modal_decay(0.01, CYCLES)
    assert exact == pytest.approx(0.284592, abs=1e-6)
    given, numerics = scene(damping([frequency for frequency, _ in found])), Numerics(safety=safety)
    ringing = Ringing(loop_on(given, bar(6), numerics), *found[mode])
    assert ringing.decay(0.01, CYCLES) == pytest.approx(exact, rel=5e-3)
    control = Ringing(changed(loop_on(given, bar(6), numerics), mass_rate=0.0), *found[mode])
    assert control.decay(0.01, CYCLES) > 1.05 * exact


@pytest.mark.case("O17")
def test_different_ratios_at_the_two_frequencies(found):
    ratios = (0.02, 0.008)
    given = scene(damping([frequency for frequency, _ in found], ratios))
    for (frequency, shape), ratio in zip(found, ratios):
        ringing = Ringing(loop_on(given, bar(6)), frequency, shape)
        assert ringing.decay(ratio, CYCLES) == pytest.approx(
            elasticity.modal_decay(ratio, CYCLES), rel=5e-3
        )


@pytest.mark.case("X17")
@pytest.mark.parametrize("safety", [0.9, pytest.param(0.45, marks=pytest.mark.slow)])
def test_faint_damping_over_a_hundred_thousand_cycles(safety):
    """Ratio 1e-5 in the highest mode of two elements, three to seven steps a cycle: exp(-2 pi) =
    0.00186744 is left, and at no time more than before. Control: the classical Runge-Kutta method,
    at four times the cost, has lost everything."""
    highest, shape = highest_mode(loop_on(scene(), bar(2)).setup.system.operator)
    frequency, cycles = highest / (2.0 * math.pi), 100_000
    given = scene(damping([0.5 * frequency, frequency], (1e-5, 1e-5)))
    ringing = Ringing(loop_on(given, bar(2), Numerics(safety=safety)), frequency, shape)
    exact = elasticity.modal_decay(1e-5, cycles)
    left = np.cumprod([ringing.decay(1e-5, cycles / 50) for _ in range(50)])
    assert (np.diff(left) < 0.0).all()
    assert left[-1] == pytest.approx(exact, rel=0.05)
    assert (
        np.abs(ringing.loop.stepper.state.displacement).max()
        < 2.0 * exact * 1e-6 * np.abs(shape).max()
    )
    turn = highest * ringing.loop.setup.stepping.dt_s
    per_step = np.polyval(
        [1 / 24, 1 / 6, 1 / 2, 1, 1], turn * complex(-1e-5, math.sqrt(1.0 - 1e-10))
    )
    assert not abs(abs(per_step) ** (2.0 * math.pi * cycles / turn) / exact - 1.0) < 0.05


@pytest.mark.case("O15")
@pytest.mark.parametrize("ratio", [0.05, 0.9])
def test_step_of_a_damped_rail_keeps_below_the_damped_limit(ratio):
    """The highest mode has the damping ``ratio``. Control: at the undamped limit the motion grows
    without bound."""
    highest, shape = highest_mode(loop_on(scene(), bar(2)).setup.system.operator)
    frequency = highest / (2.0 * math.pi)
    # An interval that the raster of steps does not divide: the largest step that lands on every
    # sample is close to the limit.
    given = scene(damping([0.5 * frequency, frequency], (ratio, ratio))).replace(
        {"output.interval": 1.01e-3}
    )
    limit = stable_step.critical_step(highest, ratio)
    largest = {}
    for step in (None, 1.001 * limit, 0.999 * stable_step.critical_step(highest)):
        loop = loop_on(given, bar(2), Numerics(safety=1.0))
        assert 0.99 * limit < loop.setup.stepping.dt_s <= loop.setup.stepping.dt_limit_s <= limit
        assert loop.setup.stepping.damping_ratio == pytest.approx(ratio, rel=2e-3)
        stepping = loop.setup.stepping
        replace_constants(loop, stepping=replace(stepping, dt_s=step or stepping.dt_s))
        Ringing(loop, frequency, shape)  # sets the loop going
        loop.advance_steps(40_000 if step is None or step < 1.01 * limit else 400)
        largest[step] = np.nan_to_num(np.abs(loop.stepper.state.displacement), nan=np.inf).max() / (
            1e-6 * np.abs(shape).max()
        )
    chosen, above, undamped = largest.values()
    assert chosen <= 1.0 and above > 1e3 and undamped > 1e3
    with pytest.raises(stable_step.StepError, match="is not stable"):
        loop_on(given, bar(2), Numerics(step=1.001 * loop.setup.stepping.dt_limit_s))


def test_limit_with_contact_encloses_the_coupled_system():
    """At the bound M - dt C / 2 - dt^2 (K + S) / 4 is still not negative, with springs S on every
    node across the bar; and the bound is exact where the highest mode of the rail has all of the
    springs."""
    operator = loop_on(scene(), bar(2)).setup.system.operator
    stiffness, mass, _ = free_stiffness(operator)
    matrix = stiffness.toarray() / np.sqrt(np.outer(mass, mass))
    springs = np.where(np.arange(mass.size) % 3 == 1, 3e9, 0.0) / mass
    rail = math.sqrt(np.linalg.eigvalsh(matrix)[-1])
    for alpha, beta in ((1e3, 0.0), (1e3, 0.5 / rail), (0.0, 1.0 / rail)):
        step = step_limit(Damping(alpha, beta), rail, springs.max())
        damped = alpha * np.eye(mass.size) + beta * matrix
        taken = np.linalg.eigvalsh(
            0.25 * step**2 * (matrix + np.diag(springs)) + 0.5 * step * damped
        )[-1]
        assert 0.5 < taken <= 1.0
        single = 0.25 * step**2 * (rail**2 + springs.max()) + 0.5 * step * (alpha + beta * rail**2)
        assert single == pytest.approx(1.0, rel=1e-12)


def test_friction_adds_to_what_damping_takes_of_the_step():
    """A fraction f of the limit takes f^2 g^2 + 2 z f g of the condition, g = sqrt(1 + z2) - z: 1
    at the limit, f^2 undamped."""
    for ratio in (0.0, 0.05, 1.0):
        assert used(1e-7, 1e-7, ratio) == pytest.approx(1.0, rel=1e-14)
    assert used(0.9e-7, 1e-7, 0.0) == pytest.approx(0.81, rel=1e-14)
    assert used(0.9e-7, 1e-7, 1.0) > 0.88
