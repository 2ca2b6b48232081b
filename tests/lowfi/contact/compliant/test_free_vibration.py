"""Rails that no face presses: their modes against the exact oscillator, and touches of a wall that
vibrates freely."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from tests.lowfi.compliance import REFERENCE, handmade, reference_compliance
from tests.lowfi.contact.compliant.test_runs import EFFECTS, RUB, on_springs
from tipoff import lowfi
from tipoff.kernels.jit import entry
from tipoff.lowfi import Numerics
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import free_vibration
from tipoff.lowfi.dynamics import integrate
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.mechanics.rail_compliance.patterns import DRAGGED

OMEGA, SWING = 2.0 * np.pi * 3000.0, 2e-6  # 1/s; m, amplitude of the wall
MU = 0.2  # friction of a pad that does not slide


@entry
def oscillated(square, drag, time, q, rate):
    return free_vibration.oscillated(square, drag, time, q, rate)


@pytest.mark.parametrize("ratio", [0.0, 0.01, 1.0 - 1e-9, 1.0, 1.0 + 1e-6, 3.0, 50.0])
@pytest.mark.parametrize("turns", [0.01, 0.7, 40.0])
def test_a_free_mode_follows_the_exponential_of_its_matrix(ratio, turns):
    drag, time, start = 2.0 * ratio * OMEGA, turns / OMEGA, np.array([1e-6, 0.5e-6])
    # rates over omega, so that both numbers of the state have one size
    exact = expm(time * np.array([[0.0, OMEGA], [-OMEGA, -drag]])) @ start
    q, rate = oscillated(OMEGA**2, drag, time, start[0], OMEGA * start[1])
    assert [q, rate / OMEGA] == pytest.approx(exact, rel=1e-5, abs=1e-11 * 1e-6)


def vibrating(gap: float, speed: float, rubbed: float = 0.0) -> tuple[SingleRun, np.ndarray]:
    """A payload that nothing pushes, with one flat pad ``gap`` (m) from a wall that it approaches at
    ``speed`` (m/s); the wall vibrates in one mode, its amplitude ``SWING``, of which friction has the part
    ``rubbed``. Its first state too."""
    heavy = {"inertia": {"xx": 1e6, "yy": 1e6, "zz": 1e6}}
    pad = {"position": (0.0, 0.1, 0.1), "normals": ["+y"], "length": 0.016, "width": 0.016}
    asked = on_springs(
        RUB | {"static": MU, "dynamic": MU},
        interface_stiffness=1e9,
        pads=[pad | {"inset": 0.009, "relief": 0.0}],
        duration=5e-3,
        payload=heavy | {"mass": 1e3},
        platform=heavy | {"mass": 1e9, "mass_centre": {"x": 0.0}},
        thrust=EFFECTS["thrust"] | {"peak": 0.0},
        initial={"position": {"y": 1e-4 - gap}, "velocity": {"y": speed}},
        output={"interval": 1e-6},
    )
    shape = np.zeros((2, 1, PATTERNS, 1))
    shape[:, 0, 0] = 1.0 - rubbed
    along, dragged = np.zeros((2, 1, DRAGGED, 1)), np.zeros((2, 1, 1, DRAGGED, DRAGGED))
    along[:, 0, 0] = 2.0 * rubbed / MU
    dragged[..., 0, 0] = (1.0 - rubbed) * 2.0 * rubbed / MU / OMEGA**2
    compliance = replace(
        handmade(asked, {(0, 0, 0, 0): 2.0 / OMEGA**2}),
        frequency=np.array([[OMEGA]]),
        shape=shape,
        dragged=dragged,
        dragged_shape=along,
    )
    run = SingleRun(asked, Numerics(modes=1), compliance)
    begun = np.concatenate([run.loop.start[: slot.STATE_SIZE], [SWING, 0.0]])
    run.loop = integrate.ready(run.system, begun, run.plan.first)
    return run, begun


@pytest.mark.parametrize("rubbed", [0.0, 0.9])
@pytest.mark.parametrize("speed", [0.0, 1e-3, 5e-3, 8e-3])
def test_a_touch_of_a_vibrating_wall_is_not_missed(speed, rubbed):
    """The first root of gap - speed t + SWING cos(omega t) = 0: a wall towards a pad at rest, or a pad
    that comes in slowly from a distance that long steps cross. Control: the wall at its middle
    would touch later than that by more than a sample."""
    gap = 0.999 * SWING if speed == 0.0 else 4.4e-6
    time = np.linspace(0.0, 5e-3, 1_000_001)
    away = gap - speed * time + SWING * np.cos(OMEGA * time)
    first = time[np.argmax(away < 0.0)]
    run, _ = vibrating(gap, speed, rubbed)
    run.begin()
    run.integrate(None)
    touched = np.argmax(run.forces[: run.taken, 0, 1] < 0.0) * run.interval
    assert first < touched < first + 2.0 * run.interval
    assert speed == 0.0 or gap / speed > first + 5.0 * run.interval


def test_a_pad_beyond_the_swing_of_a_wall_costs_no_steps():
    """A gap of four times the swing: fifteen periods in a few steps. Control: half a percent less than
    the swing, and the steps resolve the vibration until the wall strikes."""
    few, _ = vibrating(4.1 * SWING, 0.0)
    many, _ = vibrating(1.005 * SWING, 0.0)
    for run in (few, many):
        run.begin()
        run.integrate(None)
        assert not run.forces.any()
    assert few.loop.counts.steps < 30 < 100 < many.loop.counts.steps


@pytest.mark.parametrize("condition", ["phi35", "h7"])
def test_four_modes_need_few_more_steps(condition):
    """Between contacts none, and in contact what the fourth mode needs. Steps that resolve the
    vibration between contacts would be more than ten times as many."""
    asked, compliance = REFERENCE.condition(condition), reference_compliance()
    without, four = (
        lowfi.run(asked, compliance=compliance, numerics=Numerics(modes=count)).cost["steps"]
        for count in (0, 4)
    )
    assert four < 4.0 * without
