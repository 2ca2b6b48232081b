"""X20: a run that is stopped at 37 % and resumed by another program ends in the same bits."""

import numpy as np
import pytest

from tests.written_names import ARRAYS
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.lowfi.dynamics import integrate
from tipoff.lowfi.dynamics.loop import Loop
from tipoff.lowfi.single_run import SingleRun
from tipoff.scenes import load

ASKED = load("sensitive").condition("phi35")


def stopped_run(tolerance: float, last: int, path) -> SingleRun:
    """A run that was stopped at sample ``last``, made anew from the scene and the arrays in a
    file."""
    numerics = Numerics(relative_tolerance=tolerance)
    run = SingleRun(ASKED, numerics)
    run.begin()
    run.advance(last)
    assert run.taken == last + 1
    np.savez(
        path,
        rows=run.rows,
        forces=run.forces,
        **{name: array for name, array in run.loop._asdict().items() if array is not None},
    )
    kept, other = np.load(path), SingleRun(ASKED, numerics)
    loop = {name: kept.get(name) for name in Loop._fields}
    for name in ("clock", "counts", "audit"):
        # Files do not say that records are aligned, and others need a kernel of their own.
        aligned = loop[name].reshape(1).astype(getattr(run.loop, name).dtype)
        loop[name] = aligned.view(np.recarray)[0]
    other.loop = Loop(**loop)
    other.rows, other.forces, other.taken = kept["rows"], kept["forces"], last + 1
    return other


@pytest.mark.case("X20")
@pytest.mark.parametrize("tolerance", [2e-7, 1e-9])
def test_resumed_run_ends_in_the_same_bits(tolerance, tmp_path):
    whole = lowfi.run(ASKED, "springs", numerics=Numerics(relative_tolerance=tolerance))
    last = round(0.37 * (whole.time.size - 1))
    run = stopped_run(tolerance, last, tmp_path / "run.npz")
    run.integrate(None)
    resumed = run.trajectory()
    assert resumed.status == whole.status == "exited" and resumed.outcome == whole.outcome
    assert all(np.array_equal(getattr(resumed, name), getattr(whole, name)) for name in ARRAYS)
    # Control: with the state alone kept, and not the size of the next step and the stages, it ends
    # elsewhere.
    poor = stopped_run(tolerance, last, tmp_path / "run.npz")
    kept, rows, forces = poor.loop, poor.rows.copy(), poor.forces.copy()
    poor.loop = integrate.ready(poor.system, kept.end, poor.interval)
    poor.begin()
    poor.loop.clock.now, poor.loop.counts.samples = kept.clock.now, last + 1
    poor.loop.counts.segment = kept.counts.segment
    poor.rows, poor.forces = rows, forces
    poor.integrate(None)
    assert poor.taken == len(whole.time) and not np.array_equal(poor.trajectory().rate, whole.rate)
