"""X20: a run that is put away at 37 % and taken up by another program ends in the same bits."""

import pickle

import numpy as np
import pytest

import lowfi
from lowfi import Numerics, march
from lowfi.run import Run
from scenes import load

ASKED = load("sensitive").condition("phi35")
ARRAYS = ("time", "position", "velocity", "quaternion", "rate", "platform_position", "platform_velocity", "platform_rate",
          "pad_force", "energy", "transverse_energy")


def put_away(tolerance: float, last: int) -> Run:
    """A run stopped at sample ``last``, as bytes and back."""
    run = Run(ASKED, Numerics(relative_tolerance=tolerance))
    run.begin()
    run._advance(last)
    assert run.taken == last + 1
    return pickle.loads(pickle.dumps(run))


@pytest.mark.case("X20")
@pytest.mark.parametrize("tolerance", [2e-7, 1e-9])
def test_resumed_run_ends_in_the_same_bits(tolerance):
    whole = lowfi.run(ASKED, numerics=Numerics(relative_tolerance=tolerance))
    last = round(0.37 * (whole.time.size - 1))
    run = put_away(tolerance, last)
    run.march(None)
    resumed = run.trajectory()
    assert resumed.status == whole.status == "exited" and resumed.outcome == whole.outcome
    assert all(np.array_equal(getattr(resumed, name), getattr(whole, name)) for name in ARRAYS)
    # Control: with the state alone kept, and not the size of the next step and the stages, it ends elsewhere.
    poor = put_away(tolerance, last)
    fresh = march.ready(poor.system, poor.loop.end, poor.interval)
    fresh.clock[march.NOW], fresh.count[march.TAKEN] = poor.loop.clock[march.NOW], last + 1
    fresh.count[march.SEGMENT] = poor.loop.count[march.SEGMENT]
    poor.loop = fresh
    poor.march(None)
    assert poor.taken == len(whole.time) and not np.array_equal(poor.trajectory().rate, whole.rate)
