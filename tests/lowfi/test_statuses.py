"""Every run has a status, and only a status with a result has numbers."""

import dataclasses

import numpy as np
import pytest

from tipoff import lowfi
from tipoff.lowfi.ensemble import columns
from tipoff.scenes import load

BASE = load("clamped").condition("phi15")
ENDS = {
    "exited": ({}, {}),
    "time_limit": ({"duration": "5 ms"}, {}),
    "jammed": ({"thrust.peak": 0.05}, {}),
    "spent": ({}, {"maximum_steps": 20}),
    "overflow": ({"thrust.peak": 1e200, "thrust_offset.misalignment.axial": 0.0}, {}),
}
STATUS = {"spent": "diverged", "overflow": "diverged"}


def ended(name: str):
    overrides, numerics = ENDS[name]
    return lowfi.run(BASE.replace(overrides), "springs", numerics=lowfi.Numerics(**numerics))


@pytest.mark.parametrize("name", ENDS)
def test_status_and_its_values(name):
    """Settled values only with an exit; a reason with a failure; finite samples always."""
    run = ended(name)
    assert run.status == STATUS.get(name, name)
    assert all(
        (value is not None) == (name == "exited") for value in run.outcome._asdict().values()
    )
    assert bool(run.message) == (run.status == "diverged")
    for field in dataclasses.fields(run):
        value = getattr(run, field.name)
        assert not isinstance(value, np.ndarray) or np.isfinite(value).all(), field.name
    assert all(np.isfinite(value) for value in {**run.checks, **run.cost}.values())


def test_exit_without_a_settled_window_has_no_settled_values():
    """The scene ends after the exit and before the window does: time_limit, an exit time and the
    values at exit, nothing else."""
    exit_time = ended("exited").outcome.exit_time
    run = lowfi.run(BASE.replace({"duration": exit_time + 1e-3}), "springs")
    assert run.status == "time_limit"
    assert run.outcome.exit_time == pytest.approx(exit_time, rel=1e-9)
    known = {name for name, value in run.outcome._asdict().items() if value is not None}
    assert known == {"exit_time", "exit_velocity", "exit_rate", "impulse_after_exit"}


def test_saved_results_hold_no_number_either(tmp_path):
    """Control: of all statuses only the exit has a rate when it is read back."""
    for name in ENDS:
        path = tmp_path / f"{name}.nc"
        ended(name).save(path)
        found = type(ended(name)).load(path)
        assert found.status == STATUS.get(name, name) and (found.outcome.rate is not None) == (
            name == "exited"
        )


def test_tables_of_runs_hold_none_either():
    """In an ensemble the settled values of all runs but the exited are NaN, so that a mean over
    them is NaN too."""
    rows = [overrides for name, (overrides, numerics) in ENDS.items() if not numerics]
    found = lowfi.run_many(BASE, rows, "springs")
    assert found.status.values.tolist() == ["exited", "time_limit", "jammed", "diverged"]
    for name in columns.UNITS:
        values = found[name].values
        assert np.isfinite(values[0]).all() and np.isnan(values[1:]).all(), name
