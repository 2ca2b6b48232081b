"""X18: the platform turns three full turns while it ejects. Motion relative to it must not depend
on inertial axes, nor jump at a full turn.

The turns take 38 s at 0.5 rad/s, so the payload creeps: 0.1 m/s along a rail of 3 m. A thrust
across the rail holds it in a corner, since in the clearance centrifugal force would make any
rounding error grow by exp(0.5 * 38) = 1e8; the axis lies 0.4 deg off the rail's, so that Coriolis
force presses too.
"""

import functools

import numpy as np
import pytest

from tests import turning
from tests.lowfi.support import corners, scene, turned_state
from tipoff.kernels import rotation
from tipoff.lowfi import Numerics, state
from tipoff.lowfi.dynamics import integrate
from tipoff.lowfi.single_run import SingleRun

RATE, OFFSET, ARM = (0.5, 0.003, -0.002), 1.2e-4, (0.1, 1.2e-4, 1.2e-4)
ISOTROPIC = {"xx": 4.9, "yy": 4.9, "zz": 4.9}
TURNING = scene(
    39.0,
    0.02,
    mass=9.9,
    inertia={"xx": 0.066, "yy": 0.134, "zz": 0.128},
    pads=corners(0.08),
    rail={
        "start": -0.1,
        "end": 3.2,
        "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
    },
    platform={"mass": 81.2, "inertia": ISOTROPIC, "mass_centre": {"x": -0.1}},
    # A damping that starts at nothing: one that jumps where a pad touches would show how exactly
    # that instant is found.
    contact={
        "law": "impact",
        "clearance": 1e-4,
        "exponent": 1.0,
        "stiffness": 1e3,
        "damping": 60.0,
        "damping_depth": 1e-4,
    },
    friction={"static": 0.02, "dynamic": 0.02, "static_speed": 1e-3, "dynamic_speed": 2e-3},
    thrust={"kind": "gaussian", "peak": 1.0, "width": 7.0, "centre": 15.0, "arm": 1e-6},
    thrust_offset={"misalignment": {"axial": np.pi / 2, "radial": np.pi / 4}},
    initial=turning.carried(RATE, ARM, 0.12) | {"position": {"y": OFFSET, "z": OFFSET}},
)
NUDGE = rotation.exponential((1e-9, 0.0, 0.0))


def ejected(tolerance: float, turn=None, bodies=state.BODIES):
    """The run, its bodies turned beforehand about the scene's origin by the quaternion ``turn``."""
    run = SingleRun(TURNING, Numerics(relative_tolerance=tolerance))
    if turn:
        run.loop = integrate.ready(
            run.system, turned_state(state.initial(run.model), turn, bodies), run.interval
        )
    # what is left of the thrust does not keep the payload from settling
    run.marks = run.marks._replace(settled_thrust=0.0)
    run.begin()
    run.integrate(None)
    return run.trajectory()


@functools.cache
def as_it_is(tolerance: float):
    """The run as the scene says."""
    return ejected(tolerance)


@pytest.mark.case("X18")
@pytest.mark.parametrize("tolerance", [7e-13, pytest.param(2e-13, marks=pytest.mark.slow)])
def test_three_turns_seen_from_the_platform(tolerance):
    """Outputs agree to 1e-9 of their size, exit and settled values too."""
    run, other = as_it_is(tolerance), ejected(tolerance, turning.TURN)
    assert run.status == other.status == "exited"
    assert turning.turns(run.platform_quaternion) > 3.0 and turning.turns(run.quaternion) > 3.0
    assert np.abs(run.pad_force).max() > 0.1
    assert max(turning.differences(run, other).values()) <= 1e-9
    assert other.outcome.exit_time == pytest.approx(run.outcome.exit_time, rel=1e-9)
    assert other.outcome.rate == pytest.approx(run.outcome.rate, abs=1e-9)
    assert turning.turned(run.outcome.velocity) == pytest.approx(other.outcome.velocity, abs=1e-9)
    # Control: it would see that only the payload starts turned, by as much as moves its pads by a
    # tenth of a nanometre.
    assert (
        max(turning.differences(run, ejected(tolerance, NUDGE, state.BODIES[:1])).values()) > 1e-9
    )


@pytest.mark.case("X18")
def test_no_output_jumps_at_a_full_turn():
    """Nothing changes by more in one sample than its rate allows. Controls: angles that wrap jump
    by a whole turn, and a relative velocity without the rotation of the frame differs much from the
    payload's motion on the rail."""
    run = as_it_is(7e-13)
    turning.assert_smooth(run, 0.02, np.linalg.norm(RATE))
    assert turning.largest_jump(turning.principal(run.quaternion)) > 5.0
    assert turning.without_frame(run) > 30.0
