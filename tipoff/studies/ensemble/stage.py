"""Stage ``ensemble``: many varied cases of the surrogate in a store, and the statistics of their
results."""

import resource
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import write_json
from tipoff.lowfi.ensemble import columns, twins
from tipoff.lowfi.ensemble.batch import Case
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.lowfi.ensemble.store import Store, StoreError
from tipoff.lowfi.ensemble.table import TableFile
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics import instant
from tipoff.mechanics.instant import Instant
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.results import hand_over
from tipoff.scenes import halving, implausible, uncertainty
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.agreement import kept, verdicts
from tipoff.studies.calibration.files import constants
from tipoff.studies.ensemble import halves, sensitivity, summary
from tipoff.studies.ensemble.halves import Halved
from tipoff.studies.ensemble.options import EnsembleOptions
from tipoff.studies.ensemble.sensitivity import Sensitivity
from tipoff.studies.ensemble.summary import Statistics
from tipoff.studies.populations import exceedance, population
from tipoff.studies.populations.exceedance import Limit
from tipoff.workspace import kernel_marks, machine, words
from tipoff.workspace.attempt import attempt
from tipoff.workspace.progress import Board, say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study, StudyError, numerics_faults
from tipoff.workspace.words import counted


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Cost of the cases that were run: wall time; processor time of each case, None if other
    machines ran them or without a case; peak memory of the process, None for twins."""

    cases: int
    wall_s: float
    scheduler: str | None
    cpu_ms_per_case: float | None
    peak_memory_bytes: int | None = None


@dataclass(frozen=True, kw_only=True)
class Sensitive(Sensitivity):
    """The same with the cost of the twins by cause."""

    run: dict[str, Cost]


@dataclass(frozen=True, kw_only=True)
class Ran(Statistics):
    """The result: statistics of the ``store``; ``sensitivity`` None if not requested, ``halves`` empty
    if not."""

    stage: str = "ensemble"
    scene: str
    quantities: str
    implausible: list[str]
    store: str
    sensitivity: Sensitive | None
    halves: tuple[Halved, ...]
    agreement: str
    run: Cost
    hardware: dict[str, Any]

    @property
    def plain(self) -> dict:
        """The content of the result file."""
        return asdict(self)


@dataclass(frozen=True, kw_only=True)
class One:
    """One case run alone: inputs as text; changes of the rates by cause (deg/s), None if not
    requested; ``stored``: whether its store has the same bits, None without a stored result."""

    case: int
    inputs: dict[str, str]
    found: Case
    limit_deg_s: float
    changes: dict[str, float | None] | None
    stored: bool | None

    @property
    def plain(self) -> dict:
        """The case as JSON values."""
        found = {"case": self.case, "inputs": self.inputs, "stored": self.stored}
        if self.changes is not None:
            found["sensitivity"] = {"limit_deg_s": self.limit_deg_s, "by": self.changes}
        run = self.found
        whole = {"status": run.status, "message": run.message, "steps": run.steps}
        return found | whole | run.outcome._asdict()


def request(study: Study, options: EnsembleOptions) -> tuple[Ensemble, Path]:
    """The ensemble of the ``options``, and the folder of its store: the given one, or by default a
    separate one for every ensemble. The number of modes is that of the store, or pilot cases choose
    it. Raises SceneError for bad input, before any rail compliance is computed, and StudyError where
    no model is named and the agreement table rejects the default."""
    fitted = constants(options.chosen.calibration, options.chosen.model, study.scene.name)
    changed = {
        name: value for name in ("vary", "cases") if (value := getattr(options, name)) is not None
    }
    if options.table is not None:
        expected = "no such option: the table lists its cases"
        faults = [Fault("--table", name, str(value), expected) for name, value in changed.items()]
        if options.halve:
            faults.append(
                Fault("--table", "halve", "yes", "no such option: a table has no tolerances")
            )
        if faults:
            raise SceneError(faults)
        source: Any = TableFile(options.table)
    else:
        vary = uncertainty.chosen(changed.pop("vary", None), study.scene)
        drawn = uncertainty.load(vary, study.scene, **changed)
        if options.vary is not None:  # those of the scene are among its warnings
            for words in uncertainty.far_from_scene(drawn, study.scene):
                say(f"warning: {words}")
        source = Drawn(drawn)
    springs = options.chosen.model == SPRINGS
    try:
        numerics = Numerics.of_many(
            options.tolerance, options.chosen.asked, SPRINGS if springs else COMPLIANT
        )
    except ValueError as error:
        raise SceneError(numerics_faults(error)) from None
    if options.store is not None and options.store.exists() and not options.store.is_dir():
        raise SceneError([Fault("--store", "path", str(options.store), "a folder")])
    kept.require_accepted(study, options.chosen.name)
    scene = study.scene
    found = (
        study.rigid_rails(scene)
        if springs
        else study.rail_compliance(scene, run_degree=numerics.known_degree)
    )
    if fitted is not None and not springs:  # before a case, which may vary a constant
        scene, fitted = fitted.split(scene)
    asked = Ensemble(scene, source, calibration=fitted, numerics=numerics, compliance=found)
    path = options.store or study.path(f"ensemble-{asked.key[:8]}")
    like = Run(
        "lowfi", "ensemble", scene=scene, numerics=numerics, calibration=fitted, compliance=found
    )
    with kernel_marks.first_use(like):
        ensemble = population.chosen_modes("ensemble", asked, path)
    if ensemble.modes_why:
        say(f"modes of each rail {ensemble.modes_why}")
    return ensemble, path


def run(study: Study, options: EnsembleOptions) -> Ran:
    """Run the cases that the store lacks, then their twins if the sensitivity is requested. Returns
    the statistics, also written as ``ensemble.json``. Raises StudyError when the store fails."""
    limits = exceedance.limits(options.limits)
    if options.export:
        hand_over.require(options.export[0], study.scene.resolved())
    ensemble, path = request(study, options)
    if options.export:
        hand_over.require_fixed(ensemble.source.keys)
    try:
        store = ensemble.store(path)
        ensemble.case(0)  # compiles the kernels or loads them from disk, before a time is taken
        tolerances = halving.tolerances(ensemble.source.uncertainty) if options.halve else {}
        fills = 1 + len(tolerances) + (len(sensitivity.CAUSES) if options.sensitivity else 0)
        at = _instant(ensemble, options)
        with Board("ensemble", fills) as board:
            cost = _filled(study, ensemble, store, options, board)
            told = _sensitivity(study, ensemble, store, options, board)
            rows = _halves(study, ensemble, store, options, board, at, limits)
    except StoreError as fault:
        raise StudyError(str(fault)) from fault
    if options.export:
        _export(study, store, options.export)
    memory = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    calibrated = options.calibration is not None
    found = Ran(
        **vars(summary.summarized(ensemble, store, calibrated, at, limits)),
        scene=study.scene.name,
        quantities=words.QUANTITIES,
        implausible=[*implausible.of_all_conditions(study.scene), *population.doubtful(ensemble)],
        store=str(path),
        sensitivity=told,
        halves=rows,
        agreement=_agreement(study, options),
        run=replace(cost, peak_memory_bytes=memory),
        hardware=machine.describe(),
    )
    found = _drawn(found, store, limits)
    write_json(study.path("ensemble.json"), found.plain)
    return found


def _drawn(found: Ran, store: Store, limits: list[Limit]) -> Ran:
    """The result, after its figures are drawn into the folder of its ``store``; ``failed`` of it has the
    reason if they cannot be drawn."""

    def files() -> None:
        from tipoff.studies.ensemble import figures
        from tipoff.studies.render import chart

        rates = np.degrees(store.column(_rate(found.at)))
        settled = rates[np.isfinite(rates[:, 0])]
        if len(settled):
            shown = figures.of_rates(settled, limits, Instant(found.at, found.at_why).words)
            chart.to_files(shown, store.path)
        if found.halves:
            words_ = [limit.words for limit in limits]
            chart.to_files(figures.of_halves(found.halves, words_), store.path)

    _, reason = attempt("drawing the figures", files)
    return replace(found, failed=[*found.failed, f"figures: {reason}"]) if reason else found


def _rate(at: str) -> str:
    """The column of the rates at an instant."""
    return "exit_rate" if at == instant.EXIT else "rate"


def _export(study: Study, store: Store, export: tuple[str, Path]) -> None:
    """Write mean and covariance of the state at exit of the cases that have one."""
    left = np.isfinite(store.column("exit_position")[:, 0])
    wanted = ("exit_time", "exit_position", "exit_velocity", "exit_attitude", "exit_rate")
    found = SimpleNamespace(**{name: store.column(name)[left] for name in wanted})
    kind, path = export
    say(
        "\n".join(hand_over.words(hand_over.write(kind, path, study.scene.resolved(), found), path))
    )


def _instant(ensemble: Ensemble, options: EnsembleOptions) -> Instant:
    """The instant of the statistics: the one asked for, or by one run of the scene."""
    own = None if options.at else ensemble.nominal().outcome.impulse_after_exit
    return instant.chosen(options.at, own)


def _filled(
    study: Study,
    ensemble: Ensemble,
    store: Store,
    options: EnsembleOptions,
    board: Board,
    cause: str = "",
) -> Cost:
    """Run the cases that a store lacks; ``cause`` in words for twins."""
    label = counted(store.asked, "case") + (cause and f", {cause}")
    report, began, processor = board.callback(label), time.perf_counter(), time.process_time()
    new = fill(
        ensemble,
        store,
        study.settings.workers,
        options.scheduler,
        lambda stored: report(stored / store.asked),
    )
    wall, spent = time.perf_counter() - began, time.process_time() - processor
    board.finished(label, f"{new:,} run in {wall:.3g} s" if new else "all of them stored before")
    each = 1e3 * spent / new if new and not options.scheduler else None
    return Cost(cases=new, wall_s=wall, scheduler=options.scheduler, cpu_ms_per_case=each)


def _sensitivity(
    study: Study, ensemble: Ensemble, store: Store, options: EnsembleOptions, board: Board
) -> Sensitive | None:
    """How far the twins of the cases differ, and the cost of each; None if not requested."""
    if not options.sensitivity:
        return None
    disturbed, costs = {}, {}
    for cause, twin in twins.of_ensemble(ensemble).items():
        disturbed[cause] = twins.opened(twin, cause, store)
        words_ = sensitivity.CAUSES[cause]
        costs[cause] = _filled(study, twin, disturbed[cause], options, board, words_)
        twins.add(store, cause, twin, disturbed[cause])
    return Sensitive(**vars(sensitivity.compared(store, disturbed, _limit(study))), run=costs)


def _halves(
    study: Study,
    ensemble: Ensemble,
    store: Store,
    options: EnsembleOptions,
    board: Board,
    at: Instant,
    limits: list[Limit],
) -> tuple[Halved, ...]:
    """What each halved tolerance gains, by the rates ``at`` an instant; the cases of each are in a store of
    their own within that of the ensemble. Empty if not requested."""
    if not options.halve:
        return ()
    rate = _rate(at.at)

    def rates(errors: Uncertainty, name: str) -> np.ndarray:
        if not name:
            return np.degrees(store.column(rate))
        changed = ensemble._replace(source=Drawn(errors))
        inside = changed.store(store.path / "halved" / name)
        _filled(study, changed, inside, options, board, f"half of {name}")
        return np.degrees(inside.column(rate))

    return halves.table(ensemble.source.uncertainty, rates, limits)


def _limit(study: Study) -> float:
    """Limit of agreement of the settled rates, deg/s, as in ``tipoff run``."""
    return verdicts.gates(study.scene).settled_rate_error_deg_s


def _agreement(study: Study, options: EnsembleOptions) -> str:
    chosen = options.chosen
    fitted = constants(chosen.calibration, chosen.model, study.scene.name)
    return kept.words(study, chosen.model, None, fitted, chosen.asked)


def case(study: Study, options: EnsembleOptions, number: int) -> One:
    """One case run alone. Raises SceneError for a case that does not exist, and StudyError when the
    store fails."""
    ensemble, path = request(study, options)
    if not 0 <= number < ensemble.source.asked:
        expected = f"0 to {ensemble.source.asked - 1}"
        raise SceneError([Fault("--case", "number", str(number), expected)])
    row, found = ensemble.case(number)
    changes = sensitivity.of_case(ensemble, number, found) if options.sensitivity else None
    kept_ = None
    if path.exists():
        try:
            store = ensemble.store(path)
            kept_ = store.read(number, number + 1)[0] if store.holds(number) else None
        except StoreError as fault:
            raise StudyError(str(fault)) from fault
    return One(
        case=number,
        inputs={key: str(value) for key, value in row.items()},
        found=found,
        limit_deg_s=_limit(study),
        changes=changes,
        stored=None if kept_ is None else _equal(kept_, columns.of_cases([found])),
    )


def _equal(stored: columns.Columns, alone: columns.Columns) -> bool:
    """Whether both have the same bits."""
    return all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(stored, alone))
