"""Stage ``ensemble``: many varied cases of the surrogate in a store, and the statistics of their
results."""

import resource
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.files import write_json
from tipoff.lowfi.ensemble import columns, pilot, twins
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.lowfi.ensemble.store import Store, StoreError
from tipoff.lowfi.ensemble.table import TableFile
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.models import SPRINGS
from tipoff.scenes import plausibility, uncertainty
from tipoff.scenes.faults import Fault, SceneError
from tipoff.studies.agreement import kept, verdicts
from tipoff.studies.calibration.files import constants
from tipoff.studies.ensemble import sensitivity, summary
from tipoff.workspace import kernel_marks, machine, models, words
from tipoff.workspace.progress import Board, say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted


@dataclass(frozen=True)
class Options:
    """Options of ``tipoff ensemble``; None: from the file of distributions, or the default. The file is
    that of ``vary``, else of the errors that the scene states, else of the paper."""

    vary: str | None = None
    table: Path | None = None
    cases: int | None = None
    seed: int | None = None
    sampling: str | None = None
    store: Path | None = None
    tolerance: float = 1e-2
    scheduler: str | None = None
    workers: int | None = None
    model: models.Options = models.Options()
    sensitivity: bool = False


def request(study: Study, options: Options) -> tuple[Ensemble, Path]:
    """The ensemble of the ``options``, and the folder of its store: the given one, or by default a
    separate one for every ensemble. The number of modes is that of the store, or pilot cases choose
    it. Raises SceneError for bad input, before any rail compliance is computed, and StudyError where
    no model is named and the agreement table rejects the default."""
    fitted = constants(options.model.calibration, options.model.model, study.scene.name)
    changed = {
        name: value
        for name in ("cases", "seed", "sampling")
        if (value := getattr(options, name)) is not None
    }
    if options.table is not None:
        if changed:
            expected = "no such option: the table lists its cases"
            raise SceneError(
                [Fault("--table", name, str(value), expected) for name, value in changed.items()]
            )
        source: Any = TableFile(options.table)
    else:
        own = study.scene.studies and study.scene.studies.errors
        vary = options.vary or own or uncertainty.DEFAULT
        source = Drawn(uncertainty.load(vary, study.scene, **changed))
    try:
        numerics = Numerics(relative_tolerance=options.tolerance, modes=options.model.asked)
    except ValueError as fault:
        given = f"{options.tolerance:g}, {options.model.modes}"
        raise SceneError([Fault("--tolerance, --modes", "numerics", given, str(fault))]) from None
    if options.store is not None and options.store.exists() and not options.store.is_dir():
        raise SceneError([Fault("--store", "path", str(options.store), "a folder")])
    kept.require_accepted(study, options.model.name)
    springs = options.model.model == SPRINGS
    found = study.rigid_rails(study.scene) if springs else study.rail_compliance(study.scene)
    scene = study.scene
    if fitted is not None and not springs:  # before a case, which may vary a constant
        scene, fitted = fitted.split(scene)
    asked = Ensemble(scene, source, fitted, numerics, found)
    path = options.store or study.path(f"ensemble-{asked.key[:8]}")
    like = Run("lowfi", "ensemble", scene, numerics, fitted, found)
    with kernel_marks.first_use(like, many=True):
        ensemble = pilot.settled(asked, path)
    if ensemble.modes_why:
        say(f"modes of each rail {ensemble.modes_why}")
    return ensemble, path


def run(study: Study, options: Options) -> dict:
    """Run the cases that the store lacks, then their twins where the sensitivity is asked for.
    Returns the statistics, also written as ``ensemble.json``. Raises StudyError when the store
    fails."""
    ensemble, path = request(study, options)
    try:
        store = ensemble.store(path)
        ensemble.case(0)  # compiles, or loads the kernels from disk, before any clock runs
        with Board("ensemble", 3 if options.sensitivity else 1) as board:
            cost = _filled(ensemble, store, counted(store.asked, "case"), options, board)
            told = _sensitivity(study, ensemble, store, options, board)
    except StoreError as fault:
        raise StudyError(str(fault)) from fault
    statistics = summary.of(ensemble, store, options.model.calibration is not None)
    cost["peak_memory_bytes"] = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    found = {
        "stage": "ensemble",
        "scene": study.scene.name,
        "quantities": words.QUANTITIES,
        "implausible": plausibility.of_all_conditions(study.scene),
        "store": str(path),
        **statistics,
        **told,
        "agreement": _agreement(study, options),
        "run": cost,
        "hardware": machine.describe(),
    }
    write_json(study.path("ensemble.json"), found)
    return found


def _filled(
    ensemble: Ensemble, store: Store, label: str, options: Options, board: Board
) -> dict[str, Any]:
    """Run the cases that a store lacks. Returns their number and cost."""
    report, began, processor = board.callback(label), time.perf_counter(), time.process_time()
    new = fill(
        ensemble,
        store,
        options.workers,
        options.scheduler,
        lambda stored: report(stored / store.asked),
    )
    wall, spent = time.perf_counter() - began, time.process_time() - processor
    board.finished(label, f"{new:,} run in {wall:.3g} s" if new else "all of them stored before")
    cost = {"cases": new, "wall_s": wall, "scheduler": options.scheduler}
    if new and not options.scheduler:
        cost["cpu_ms_per_case"] = 1e3 * spent / new
    return cost


def _sensitivity(
    study: Study, ensemble: Ensemble, store: Store, options: Options, board: Board
) -> dict[str, Any]:
    """How far the twins of the cases differ, and the cost of each; nothing where it is not asked
    for."""
    if not options.sensitivity:
        return {}
    disturbed, costs = {}, {}
    for cause, twin in twins.of(ensemble).items():
        disturbed[cause] = twins.opened(twin, cause, store)
        label = f"{counted(store.asked, 'case')}, {sensitivity.CAUSES[cause]}"
        costs[cause] = _filled(twin, disturbed[cause], label, options, board)
        twins.add(store, cause, twin, disturbed[cause])
    found = sensitivity.of(store, disturbed, _limit(study))
    return {"sensitivity": found | {"run": costs}}


def _limit(study: Study) -> float:
    """Limit of agreement of the settled rates, deg/s: that of ``tipoff run``."""
    return verdicts.gates(study.scene).settled_rate_error_deg_s


def _agreement(study: Study, options: Options) -> str:
    return kept.words(
        study,
        options.model.model,
        None,
        options.model.calibration is not None,
        options.model.asked,
    )


def case(study: Study, options: Options, number: int) -> dict:
    """One case run alone, and whether its store has the same bits (None: no stored result). Raises
    SceneError for a case that does not exist, and StudyError when the store fails."""
    ensemble, path = request(study, options)
    if not 0 <= number < ensemble.source.asked:
        raise SceneError(
            [Fault("--case", "number", str(number), f"0 to {ensemble.source.asked - 1}")]
        )
    row, found = ensemble.case(number)
    result = {
        "case": number,
        "inputs": {key: str(value) for key, value in row.items()},
        "status": found.status,
        "message": found.message,
        "steps": found.steps,
        **found.outcome._asdict(),
        "stored": None,
    }
    if options.sensitivity:
        result["sensitivity"] = {
            "limit_deg_s": _limit(study),
            "by": sensitivity.of_case(ensemble, number, found),
        }
    if path.exists():
        try:
            store = ensemble.store(path)
            stored = store.read(number, number + 1)[0] if store.holds(number) else None
        except StoreError as fault:
            raise StudyError(str(fault)) from fault
        alone = columns.of([found])
        if stored is not None:
            result["stored"] = all(
                np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(stored, alone)
            )
    return result
