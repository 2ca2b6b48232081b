"""The draws with other rail modes than those of the population.

A population has one number of rail modes, which pilot cases choose (``lowfi.ensemble.pilot``). Here the
surrogate runs each draw with the number that the draw itself chooses. It also runs all draws without
modes, with the modes of the population, and with all modes of the rail compliance. If a draw chooses
modes, a run with a little more clearance shows how sensitive the draw is.
"""

import statistics
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.mechanics.rail_compliance import may_vibrate
from tipoff.studies.populations import draws
from tipoff.studies.populations.draws import Rows
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.run import Run, execute
from tipoff.workspace.study import Study

_REPEATS = 2  # timed runs


class Series(NamedTuple):
    """``results`` of n draws with the same ``modes`` of each rail, or ``"auto"``: each draw
    chooses. ``cpu_s``: mean processor seconds of a run with loaded kernels, including the runs that
    choose the modes; ``case_s``: processor seconds of a case of a population with these modes, None
    if each draw chooses."""

    modes: int | str
    results: Columns
    cpu_s: float
    case_s: float | None = None


class OwnModes(NamedTuple):
    """``held``, modes of each rail in the rail compliance; ``chosen`` (n,), those that each draw
    chooses; ``same``, the draws with one number of modes, ascending from none to all; ``own``, with
    those ``chosen``; ``wider``, the k draws that choose some, with these and every clearance larger
    by ``clearance_change`` (m)."""

    held: int
    chosen: np.ndarray
    same: list[Series]
    own: Series
    wider: Columns
    clearance_change: float


def run(study: Study, model: Surrogate, rows: Rows) -> OwnModes | None:
    """The draws with the overrides ``rows`` of the scene on the surrogate ``model``. None if its
    rails have no modes. The store of the study keeps the runs. Raises ValueError before the
    population has chosen its modes."""
    requested = draws.beside(study, model, rows, Numerics(modes=AUTO), "-own-modes")
    if not (held := _held(requested[0])):
        return None
    found = draws.filled(study, "tails, own modes", requested)
    chosen = np.array([each.modes for each in found])
    change, at = study.settings.clearance_change, model.instant.at
    further = [_wider(each, int(count), change) for each, count in zip(requested, chosen) if count]
    return OwnModes(
        held=held,
        chosen=chosen,
        same=[_same(study, model, rows, count) for count in sorted({0, model.mode_count, held})],
        own=Series(AUTO, draws.results(found, at), _seconds(requested)),
        wider=draws.results(draws.filled(study, "tails, 1 um of clearance", further), at),
        clearance_change=change,
    )


def _held(request: Run) -> int:
    """Modes of each rail that may vibrate in a run."""
    under = request.compliance
    if under is None or not may_vibrate(request.scene, under):
        return 0
    return under.frequency.shape[1]


def _same(study: Study, model: Surrogate, rows: Rows, count: int) -> Series:
    """The draws with ``count`` modes. The store already has those with the modes of the population."""
    tag = "" if count == model.modes else f"-{count}-modes"
    requested = draws.beside(study, model, rows, Numerics(modes=count), tag)
    found = draws.filled(study, f"tails, {count} modes", requested)
    return Series(
        modes=count,
        results=draws.results(found, model.instant.at),
        cpu_s=_seconds(requested),
        case_s=draws.seconds_per_case(model._replace(modes=count), rows),
    )


def _seconds(requested: list[Run]) -> float:
    """Mean processor seconds of a run. Stored times may be of other days, and first runs include
    the loading of kernels. So each run is made twice more, and the shorter time counts."""
    times = ([execute(run).cost["cpu_s"] for run in requested] for _ in range(_REPEATS))
    return statistics.fmean(map(min, *times))


def _wider(request: Run, count: int, change: float) -> Run:
    """The run with every clearance larger by ``change`` (m), and with ``count`` modes: another
    number would look like a change by the clearance."""
    scene = request.scene
    assert scene.contact is not None  # rails with modes have contact
    return replace(
        request,
        label=f"{request.label}-clearance-plus",
        scene=scene.replace(scene.contact.widened(change)),
        numerics=replace(request.numerics, modes=count),
    )
