"""Whether a timed piece did what was asked. A loop that returns early, or a case that is left out, makes
its time too short without any other sign."""

from collections.abc import Iterable

import numpy as np

from tipoff.results.trajectory import Trajectory
from tipoff.workspace.errors import FAILED, StudyError

# ns per element and step on one thread: no processor does the 240 multiplications of an element in less
SHORTEST = 0.5


class NotDone(StudyError):
    """A timed piece did not do what was asked, so its time says nothing."""


def require(what: str, done: float, asked: float) -> None:
    """Raise NotDone unless ``done`` equals ``asked``."""
    if done != asked:
        raise NotDone(f"{what}: {done:,} done, {asked:,} asked for; the time says nothing")


def rates(table) -> int:
    """Number of cases of an ensemble's ``table`` that took steps to the end of a settled window."""
    return int((np.isfinite(table.rate.values).all(axis=1) & (table.steps.values > 0)).sum())


def runs(found: Iterable[Trajectory]) -> int:
    """Number of runs that took steps to the end of a settled window."""
    return sum(run.cost["steps"] > 0 and run.outcome.rate is not None for run in found)


def require_run(what: str, run: Trajectory, settles: bool = True) -> None:
    """Raise NotDone for a ``run`` that failed, took no step, did not settle although it ``settles``, or
    that stepped its elements in less time than any processor needs."""
    if run.status in FAILED or not run.cost["steps"] > 0:
        raise NotDone(f"{what}: {run.status} after {run.cost['steps']:,} steps; {run.message}")
    if settles:
        require(f"settled runs of {what}", runs([run]), 1)
    if stepped := run.cost.get("element_steps", 0):
        spent = 1e9 * run.cost["cpu_s"] / stepped
        require_at_least(f"ns per element and step of {what}", spent, SHORTEST)


def require_at_least(what: str, value: float, least: float) -> None:
    """Raise NotDone for a time below the shortest plausible one."""
    if not value >= least:
        raise NotDone(f"{what}: {value:.3g}, less than {least:g}: the work was not done")
