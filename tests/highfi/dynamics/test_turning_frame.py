"""X18: the frame of the rails turns three full turns while the payload leaves it. Nothing seen from
the frame may depend on the inertial axes, nor jump at a full turn.

The turns take 38 s at 0.5 rad/s. Aluminium would take 1e8 steps, so the scene is the tiny one on a
longer rail, played 300 times as slowly: with stiffnesses divided by 300^2 it takes as many steps as
a quick one. A thrust across the rail holds the payload in a corner, since in the clearance
centrifugal force would make any rounding error grow by exp(0.5 * 38) = 1e8; the axis lies 0.08 deg
off the rail's, so that Coriolis force presses too.
"""

import functools

import numpy as np
import pytest

from tests import turning
from tests.highfi.support import replace_constants, tiny
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.simulation import Loop
from tipoff.kernels import rotation

SLOWER = 300.0
RATE, OFFSET, BEHIND = (0.5, 6e-4, -4e-4), 0.06e-3, -0.05
ISOTROPIC = {"xx": 4.9, "yy": 4.9, "zz": 4.9}
# Close behind each other, so that the payload is held by both pairs of pads for most of its way.
MOUNTS = [
    {"start": start, "end": start + 0.016} for start in (0.008, 0.104, 0.192, 0.288, 0.376, 0.464)
]
PADS = [
    pad.model_dump() | {"position": (0.1125 * pad.position[0], *pad.position[1:])}
    for pad in tiny().pads
]
TURNING = tiny(
    pads=PADS,
    rail__end=0.4,
    rail__mounts=MOUNTS,
    duration=40.0,
    output__interval=0.05,
    payload__inertia={"xx": 0.013, "yy": 0.027, "zz": 0.026},
    platform__inertia=ISOTROPIC,
    rail__material__youngs_modulus=72e9 / SLOWER**2,
    contact__interface_stiffness=1.8e12 / SLOWER**2,
    contact__clearance=0.05e-3,
    payload__mass=2.0,
    friction={"static": 0.005, "dynamic": 0.005, "static_speed": 1e-3, "dynamic_speed": 2e-3},
    thrust={"kind": "gaussian", "peak": 2e-2, "width": 1e4, "centre": 0.0, "arm": 1e-6},
    thrust_offset={"misalignment": {"axial": np.pi / 2, "radial": np.pi / 4}},
    initial=turning.carried(RATE, (0.1 + BEHIND, OFFSET, OFFSET), 13.7e-3)
    | {"position": {"x": BEHIND, "y": OFFSET, "z": OFFSET}},
)
NUDGE = 1e-9  # rad, about X
TWO_STEPS = pytest.mark.parametrize("safety", [0.9, 0.7])
WHOLE, QUARTER = 40.0, 3.0  # s; a quarter of a turn ends on the rail
BODIES = ("payload", "platform")


@functools.cache
def ejected(safety: float, turn=None, bodies=BODIES, duration: float = WHOLE):
    """The run, its bodies turned beforehand about the scene's origin by the quaternion ``turn``;
    nodes are stored in frame axes."""
    numerics = Numerics(element_size=0.016, safety=safety)
    scene = TURNING.replace({"duration": duration})
    system = build(scene, numerics, highfi.prepare(scene, numerics))
    loop = Loop(set_up(scene, system, choose(system, scene, numerics)))
    # what is left of the thrust does not keep the payload from settling
    replace_constants(loop, milestones=loop.setup.milestones._replace(settled_thrust=0.0))
    for body in (getattr(loop.stepper.state, name) for name in bodies if turn):
        body.quaternion[:] = rotation.product(turn, tuple(body.quaternion))
        for vector in (body.position, body.velocity, body.spin):
            vector[:] = turning.turned(vector, turn)
    loop.begin()
    loop.integrate(None)
    return loop.trajectory({"steps": loop.stepper.steps}, numerics)


def about_x(angle: float) -> tuple:
    """A turn (quaternion) by ``angle`` (rad) about X."""
    return rotation.exponential((angle, 0.0, 0.0))


def assert_seen_alike(run, other, nudged):
    """All that moves agrees to 1e-9 (m, m/s, rad/s, J) and to 1e-8 of its own small size. Control:
    it would see that only the payload starts turned, by as much as moves its pads by a tenth of a
    nanometre for each 1e-9 rad, which is ``nudged``."""
    assert np.abs(run.pad_force).max() > 0.01
    found, ours, theirs = (
        turning.differences(run, other),
        turning.seen_from_platform(run),
        turning.seen_from_platform(other),
    )
    # A wall answers a rounding error of 1e-12 m in 0.5 m with 1e-9 N, and the largest force is 0.02
    # N: impulses agree better.
    assert found.pop("pad_force") <= 1e-5
    assert (
        np.abs(turning.impulses(other) - turning.impulses(run)).max()
        <= 1e-7 * np.abs(turning.impulses(run)).max()
    )
    assert max(found.values()) <= 1e-8
    assert max(np.abs(theirs[name] - ours[name]).max() for name in found) <= 1e-9
    seen = turning.differences(run, nudged)
    assert max(value for name, value in seen.items() if name != "pad_force") > 1e-7


@pytest.mark.case("X18")
@pytest.mark.parametrize(
    "share, nudge", [(0.1, 2.0 * NUDGE), pytest.param(1.0, NUDGE, marks=pytest.mark.slow)]
)
def test_part_of_a_turn_seen_from_the_platform(share, nudge):
    """A ``share`` of a quarter of a turn on the rail, in corner contact. The nudge of the control is
    twice as large on the short part."""
    part = share * QUARTER
    run, other = (ejected(0.9, turn, BODIES, part) for turn in (None, turning.TURN))
    assert run.status == other.status == "time_limit"
    assert 0.2 * share < turning.turns(run.platform_quaternion) < 0.3 * share
    assert_seen_alike(run, other, ejected(0.9, about_x(nudge), BODIES[:1], part))


@pytest.mark.case("X18")
@pytest.mark.slow
@TWO_STEPS
def test_three_turns_seen_from_the_platform(safety):
    """So do exit and settled values."""
    run, other = ejected(safety), ejected(safety, turning.TURN)
    assert run.status == other.status == "exited"
    assert turning.turns(run.platform_quaternion) > 3.0 and turning.turns(run.quaternion) > 3.0
    assert_seen_alike(run, other, ejected(safety, about_x(NUDGE), BODIES[:1]))
    assert other.outcome.exit_time == pytest.approx(run.outcome.exit_time, rel=1e-9)
    assert other.outcome.rate == pytest.approx(run.outcome.rate, abs=1e-9)
    assert turning.turned(run.outcome.velocity) == pytest.approx(other.outcome.velocity, abs=1e-9)


@pytest.mark.case("X18")
@pytest.mark.slow
def test_no_output_jumps_at_a_full_turn():
    """Nothing changes by more in one sample than its rate allows. Control: angles that wrap jump by
    a whole turn."""
    run = ejected(0.9)
    turning.assert_smooth(run, TURNING.output.interval, np.linalg.norm(RATE))
    assert turning.largest_jump(turning.principal(run.quaternion)) > 5.0
