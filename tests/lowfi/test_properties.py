"""Properties of every scene: accuracy limits, symmetries, time reversal without losses. Scenes are
drawn at random.

Contact amplifies small differences, by a factor that depends on the scene. So each comparison has
its own measure: the same scene with its state at ignition changed by the error of one step. Two
runs are compared as long as the effect of that change is below a thousandth of the motion; a wrong
sign or a lost term is a million times larger from the first contact on. Runs with the same steps
may differ by ten times that effect, since a pad that just touches may by rounding be open in one
and closed in the other, which makes one step different; runs with different steps, by the effect
itself.
"""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests import turning
from tests.lowfi.random_scenes import (
    DURATION,
    EFFECTS,
    INTERVAL,
    MIRROR,
    QUARTER_TURN,
    raw_scenes,
    scene_of,
    transformed,
)
from tests.lowfi.support import RAIL, turned_state, unwatched
from tipoff import lowfi
from tipoff.lowfi import Numerics, state
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics import ledger

QUICK = ("ejection", "guided", "frictionless", "free")  # kernels that other tests compile too
TOLERANCE = NUDGE = 1e-9  # relative; m/s
# m/s, below which nothing is called a motion; m from the mass centre to a pad
LEAST, REACH = 1e-2, 0.1
KINETIC = ledger.ENTRIES.index("kinetic")
FEW = settings(max_examples=12, suppress_health_check=list(HealthCheck))
MANY = settings(max_examples=420, suppress_health_check=list(HealthCheck))


def moved(raw: dict, change=None) -> SingleRun:
    """The run over its whole duration, from the scene's state at ignition or what ``change`` makes
    of it."""
    run = unwatched(scene_of(raw), Numerics(relative_tolerance=TOLERANCE), change)
    assert not run.message and run.taken == run.end + 1, run.message
    return run


def nudged(start: np.ndarray) -> np.ndarray:
    """The state with all its motions changed a little."""
    new = start.copy()
    for slot, mass in ((state.VELOCITY, 1.0), (state.SPIN, 0.1), (state.MOMENT, 0.1)):
        new[slot : slot + 3] += NUDGE * mass * np.array([1.0, -0.7, 0.4])
    return new


def speeds(run: SingleRun) -> np.ndarray:
    """Velocity, and pad speed from turning, of the payload: (n,6) m/s."""
    motion = run.motion()
    return np.hstack([motion.velocity, REACH * motion.rate])


def mapped(values: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Speeds (n,6) as seen in changed axes: velocities are polar vectors, rates axial ones."""
    return np.hstack([values[:, :3] @ matrix.T, values[:, 3:] @ (np.linalg.det(matrix) * matrix).T])


def assert_equal_motion(
    found: np.ndarray, expected: np.ndarray, perturbed: np.ndarray, factor: float = 10.0
) -> None:
    """Two runs' speeds (n,6) agree within ``factor`` times the response to the perturbation, as
    long as that is small beside the motion."""
    size = max(np.abs(expected).max(), LEAST)
    response = np.maximum.accumulate(np.abs(perturbed - expected).max(axis=1))
    telling = response < 1e-3 * size
    assert telling[0]
    excess = np.abs(found - expected).max(axis=1) - factor * response - 1e-12 * size
    assert excess[telling].max() <= 0.0


def check_promises(raw: dict) -> None:
    """A run with default numerics: right status, finite numbers, closed balances, losses that are
    not negative, steps below the limit."""
    run = lowfi.run(scene_of(raw), "springs", numerics=Numerics(relative_tolerance=TOLERANCE))
    assert run.status in ("exited", "time_limit", "jammed"), run.message
    # values at the exit may stand without settled ones
    at_exit = {"exit_time", "exit_velocity", "exit_rate", "impulse_after_exit"}
    if run.outcome.exit_time is None:
        assert all(getattr(run.outcome, name) is None for name in at_exit)
    settled = [value for name, value in run.outcome._asdict().items() if name not in at_exit]
    assert all((value is not None) == (run.status == "exited") for value in settled)
    for name in (
        "position",
        "velocity",
        "rate",
        "quaternion",
        "platform_velocity",
        "pad_force",
        "energy",
        "transverse_energy",
    ):
        assert np.isfinite(getattr(run, name)).all()
    checks = run.checks
    assert checks["linear_momentum_error"] <= 1e-12 and checks["angular_momentum_error"] <= 1e-11
    assert checks["quaternion_error"] <= 1e-12
    assert checks["energy_error"] <= 1e-6
    # Where next to nothing moves across the rail, the transverse ledger is the rounding of the
    # axial energy it leaves out.
    unexplained = np.abs(ledger.residual(run.transverse_energy)).max()
    assert (
        checks["transverse_energy_error"] <= 1e-4
        or unexplained <= 1e-14 * run.energy[:, KINETIC].max()
    )
    assert checks["friction_power_max"] <= 0.0 and checks["damping_power_max"] <= 0.0
    assert run.cost["limit_used"] <= 1.0 + 1e-9


def check_symmetries(raw: dict) -> None:
    """The mirror image, the scene turned by a right angle, and its pads in the opposite order have
    the same motion."""
    base, perturbed = speeds(moved(raw)), speeds(moved(raw, nudged))
    for matrix in (MIRROR, QUARTER_TURN):
        assert_equal_motion(
            speeds(moved(transformed(raw, matrix))), mapped(base, matrix), mapped(perturbed, matrix)
        )
    assert_equal_motion(speeds(moved(raw | {"pads": raw["pads"][::-1]})), base, perturbed)
    if "platform" in raw and "gravity" not in raw:
        check_other_axes(raw, base, perturbed)


def check_other_axes(raw: dict, base: np.ndarray, perturbed: np.ndarray) -> None:
    """With both bodies turned anyhow at ignition all velocities are turned alike, and rates in body
    axes are the same."""
    run = moved(raw, lambda start: turned_state(start, turning.TURN))
    expected, nudge = (
        np.hstack([turning.turned(values[:, :3]), values[:, 3:]]) for values in (base, perturbed)
    )
    assert_equal_motion(speeds(run), expected, nudge, factor=run.loop.counts.steps)


def reversed_motion(end: np.ndarray):
    """What turns any state into the state ``end`` with all motions reversed."""
    start = end.copy()
    for body, moment in state.BODIES:
        for first in (body + state.VELOCITY, body + state.SPIN, moment):
            start[first : first + 3] *= -1.0
    start[state.IMPULSE :] = 0.0
    return start


def check_reversal(raw: dict) -> None:
    """Without losses the reversed motion is the motion run backwards."""
    there = moved(raw)
    end = there.loop.end.copy()
    back = moved(raw, lambda _: reversed_motion(end))
    perturbed = moved(raw, lambda _: nudged(reversed_motion(end)))
    assert_equal_motion(
        -speeds(back),
        speeds(there)[::-1],
        -speeds(perturbed),
        factor=there.loop.counts.steps,
    )


def test_a_wrong_sign_is_seen():
    """Control: a mirror image that keeps the sign of one product of inertia has another motion."""
    offset = {"eccentricity": {"axial": 1e-3, "radial": 0.3}}
    raw = {
        "name": "free",
        "duration": DURATION,
        "output": {"interval": INTERVAL},
        "thrust_offset": {"misalignment": {"axial": 0.01, "radial": 0.6}, **offset},
        "mass_offset": offset,
        "pads": [{"position": (0.1, 0.1, 0.1), "normals": ["+y"]}],
        "rail": RAIL,
        "payload": {
            "mass": 5.0,
            "inertia": {"xx": 0.2, "yy": 0.3, "zz": 0.4, "xy": 0.03, "xz": 0.0, "yz": 0.0},
        },
        "thrust": {"kind": "constant", "force": 100.0, "duration": 1.0},
        "initial": {"rate": {"x": 1.0, "y": 0.5, "z": 0.2}},
    }
    mirrored = transformed(raw, MIRROR)
    mirrored["payload"]["inertia"]["xy"] *= -1.0
    with pytest.raises(AssertionError):
        assert_equal_motion(
            speeds(moved(mirrored)),
            mapped(speeds(moved(raw)), MIRROR),
            mapped(speeds(moved(raw, nudged)), MIRROR),
        )


@pytest.mark.parametrize("kind", QUICK)
@FEW
@given(data=st.data())
def test_promises_and_symmetries_of_a_few_scenes(kind, data):
    raw = data.draw(raw_scenes(kind))
    check_promises(raw)
    check_symmetries(raw)


@pytest.mark.parametrize("kind", QUICK)
@FEW
@given(data=st.data())
def test_a_few_motions_run_backwards(kind, data):
    check_reversal(data.draw(raw_scenes(kind, lossless=True)))


@pytest.mark.slow
@pytest.mark.parametrize("kind", EFFECTS)
@MANY
@given(data=st.data())
def test_promises_and_symmetries_of_two_thousand_scenes(kind, data):
    raw = data.draw(raw_scenes(kind))
    check_promises(raw)
    check_symmetries(raw)


@pytest.mark.slow
@pytest.mark.parametrize("kind", EFFECTS)
@settings(MANY, max_examples=100)
@given(data=st.data())
def test_five_hundred_motions_run_backwards(kind, data):
    check_reversal(data.draw(raw_scenes(kind, lossless=True)))
