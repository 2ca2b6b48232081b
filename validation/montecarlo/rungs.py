"""The draws with the surrogate at other settings than those of the population: what accuracy costs
in time over many random ejections.

A population has one number of rail modes, which pilot cases choose (``lowfi.ensemble.pilot``). Here
the surrogate runs all draws without modes, with the modes of the population, with those that each
draw chooses, and with all; then with the settings ``OTHERS``; and once as calibrated springs if the
study has a calibration. If a draw chooses modes, a run with a little more clearance shows how
sensitive the draw is.
"""

import statistics
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.modes import FEWEST
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.mechanics.model_names import SPRINGS
from tipoff.mechanics.rail_compliance import MODES
from tipoff.scenes.rail_compliance import may_vibrate
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.populations import draws, population
from tipoff.studies.populations.draws import Kept, Rows
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.errors import FAILED
from tipoff.workspace.run import Run, execute
from tipoff.workspace.study import Study
from validation.bench import done

OTHERS = (
    Numerics(modes=FEWEST, degree=2),
    Numerics(modes=2 * FEWEST),
    Numerics(modes=MODES, degree=4),
)
_REPEATS = 2  # timed runs


class Rung(NamedTuple):
    """``results`` of n draws of the surrogate ``model`` with the same ``numerics``; with modes
    ``"auto"`` each draw chooses. ``cpu_s``: mean processor seconds of a run with loaded kernels,
    including the runs that choose the modes; ``case_s``: processor seconds of a case of a
    population with these modes, None if each draw chooses or populations have no such settings."""

    model: str
    numerics: Numerics
    results: Columns
    cpu_s: float
    case_s: float | None = None


class Rungs(NamedTuple):
    """``held``, modes of each rail in the rail compliance; ``chosen`` (n,), those that each draw
    chooses; ``same``, the draws with one number of modes, ascending from none to all; ``own``, with
    those ``chosen``; ``others``, springs and ``OTHERS``; ``wider``, the k draws that choose
    some modes, with these and every clearance larger by ``clearance_change`` (m)."""

    held: int
    chosen: np.ndarray
    same: list[Rung]
    own: Rung
    others: list[Rung]
    wider: Columns
    clearance_change: float


def run(study: Study, model: Surrogate, rows: Rows) -> Rungs | None:
    """The draws with the overrides ``rows`` of the scene on the surrogate ``model``. None if its
    rails have no modes. The store of the study keeps the runs. Raises ValueError before the
    population has chosen its modes."""
    requested = draws.beside(study, model, rows, Numerics(modes=AUTO), "-own-modes")
    if not (held := _held(requested[0])):
        return None
    found = draws.filled(study, "tails, own modes", requested)
    chosen = np.array([each.modes for each in found])
    change = study.settings.clearance_change
    further = [_wider(each, int(count), change) for each, count in zip(requested, chosen) if count]
    wider = draws.filled(study, "tails, 1 um of clearance", further)
    return Rungs(
        held=held,
        chosen=chosen,
        same=[_same(study, model, rows, count) for count in sorted({0, model.mode_count, held})],
        own=_of(model, requested, found),
        others=[*_springs(study, model, rows), *_others(study, model, rows, held)],
        wider=draws.results(wider, model.instant.at),
        clearance_change=change,
    )


def _held(request: Run) -> int:
    """Modes of each rail that may vibrate in a run."""
    under = request.compliance
    if under is None or not may_vibrate(request.scene, under):
        return 0
    return under.frequency.shape[1]


def _rung(study: Study, model: Surrogate, requested: list[Run], words: str) -> Rung:
    return _of(model, requested, draws.filled(study, f"tails, {words}", requested))


def _of(model: Surrogate, requested: list[Run], found: list[Kept]) -> Rung:
    return Rung(
        model=model.name,
        numerics=requested[0].numerics,
        results=draws.results(found, model.instant.at),
        cpu_s=_seconds(requested),
    )


def _same(study: Study, model: Surrogate, rows: Rows, count: int) -> Rung:
    """The draws with ``count`` modes. The store already has those with the modes of the population."""
    tag = "" if count == model.modes else f"-{count}-modes"
    requested = draws.beside(study, model, rows, Numerics(modes=count), tag)
    case_s = draws.seconds_per_case(model._replace(modes=count), rows)
    return _rung(study, model, requested, f"{count} modes")._replace(case_s=case_s)


def _others(study: Study, model: Surrogate, rows: Rows, held: int) -> list[Rung]:
    """The draws with the settings ``OTHERS``, with at most the modes ``held``."""
    found = []
    for number, asked in enumerate(OTHERS, 1):
        numerics = replace(asked, modes=min(asked.count, held))
        requested = draws.beside(study, model, rows, numerics, f"-other{number}")
        found.append(_rung(study, model, requested, f"other settings {number}"))
    return found


def _springs(study: Study, model: Surrogate, rows: Rows) -> list[Rung]:
    """The draws on calibrated springs; none without a calibration."""
    if not calibrate.stored(study):
        return []
    springs = population.surrogate(study, SPRINGS)._replace(instant=model.instant)
    requested = draws.beside(study, springs, rows, Numerics(modes=0))
    return [_rung(study, springs, requested, "springs")]


def _seconds(requested: list[Run]) -> float:
    """Mean processor seconds of a run. Stored times may be of other days, and first runs include
    the loading of kernels. So each run is made twice more, and the shorter time counts. A failed run
    is no run to its end. Raises NotDone if all fail."""
    rounds = [[execute(run) for run in requested] for _ in range(_REPEATS)]
    times = []
    for request, runs in zip(requested, zip(*rounds)):
        if runs[0].status not in FAILED:
            for run in runs:
                done.require_run(request.label, run, settles=False)
            times.append(min(run.cost["cpu_s"] for run in runs))
    if not times:
        raise done.NotDone(f"none of {len(requested)} runs took its steps to the end")
    return statistics.fmean(times)


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
