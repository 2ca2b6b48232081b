"""One run of one condition in one model; prints the result."""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

from pydantic import TypeAdapter

from tipoff.faults import Fault, InputError, SceneError
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.mechanics import instant
from tipoff.mechanics.estimates import stop
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.mechanics.rail_compliance import DEGREE
from tipoff.results import hand_over
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import launch
from tipoff.scenes.scene import Scene, catalog
from tipoff.studies.agreement import kept, verdicts
from tipoff.studies.calibration.files import constants
from tipoff.studies.render.uncertain import uncertain
from tipoff.studies.runs.results import ConditionRun
from tipoff.studies.runs.stage import failure, row
from tipoff.units import duration
from tipoff.workspace import disturbed, models, words
from tipoff.workspace.attempt import attempt
from tipoff.workspace.disturbed import Disturbed
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study, StudyError

_COMPARED = (
    "highfi",
    "uncalibrated",
    "calibrated",
    "compliant",
    "modal",
)  # rungs of tipoff compare


@dataclass(frozen=True, kw_only=True)
class Single(ConditionRun):
    """A single run: its ``agreement`` as text, its changes when ``disturbed`` (None for the
    reference and if it does not settle), and ``failed``, a line if it is no success."""

    implausible: tuple[str, ...]
    agreement: str
    disturbed: Disturbed | None
    failed: tuple[str, ...]


def run(
    study: Study, condition: str, options: models.Options = models.Options(), quiet: bool = False
) -> dict:
    """The result of the run, as in the result file of a stage; prints it unless ``quiet``.

    Raises SceneError for an unreadable calibration and for options of another model, StudyError if
    no model is named and the agreement table rejects the default on ``condition``.
    """
    fitted = constants(options.calibration, options.model, study.scene.name)
    scene = study.condition(condition)
    if options.model == FINITE_ELEMENTS:
        return result_of(study, condition, study.highfi(condition), quiet)
    if options.model == SPRINGS:
        return result_of(study, condition, study.lowfi(condition, fitted), quiet)
    kept.require_accepted(study, options.name, condition)
    # checks the numerics before the rail compliance is computed
    vibrating = study.lowfi(condition, fitted, **options.numerics)
    if scene.contact is None:
        return result_of(study, condition, vibrating, quiet)
    found = study.rail_compliance(scene, degree=vibrating.numerics.needed_degree)
    request = study.lowfi(condition, fitted, compliance=found, **options.numerics)
    return result_of(study, condition, request, quiet)


def several(names: Sequence[str], make: Callable[[str], dict]) -> dict:
    """The result of ``make`` for one condition. For more conditions, ``conditions`` has a result
    for each and ``failed`` the failures of all. An error in one condition does not stop the others.
    """
    if len(names) == 1:
        return make(names[0])
    rows, failed = [], []
    for name in names:
        found, reason = attempt(name, partial(make, name), (InputError, StudyError))
        if found is None:
            failed.append(f"{name}: {reason}")
        else:
            rows.append(found)
            failed += found["failed"]
    return {"conditions": rows, "failed": failed}


def rows(found: dict) -> tuple[ConditionRun, ...]:
    """The runs in a result of ``several`` conditions."""
    return TypeAdapter(tuple[ConditionRun, ...]).validate_python(found["conditions"])


def chosen(
    study: Study, condition: str, accuracy: float | None, budget: float | None, quiet: bool = False
) -> dict:
    """The same with the model that the cost study recommends; ``chosen`` has the model and the
    reason. Raises StudyError if no model meets the limits, or without a cost study of this scene
    and code."""
    from tipoff.studies.agreement import stage as compare  # these load the finite elements,
    from tipoff.studies.cost import choice  # and a stored run of a named model does without
    from tipoff.studies.cost import stage as cost

    whole = study.unrestricted()  # stored results are of all conditions
    measured = cost.stored(whole)
    if measured is None:
        name = study.scene.name
        raise StudyError(
            "there is no cost study of this scene with this code: run tipoff cost --scene "
            f"{name if name in catalog() else 'FILE'} first"
        )
    found = choice.choose(measured.result, condition, compare.stored(whole), accuracy, budget)
    say(found.why)
    point = found.point
    if point.rung == "highfi":
        request = study.highfi(condition, element_size=point.setting)
    else:
        candidate = next(
            item for item in cost.surrogates(whole, [condition]) if item.name == point.rung
        )
        if point.modes is not None:
            candidate = candidate._replace(modes=point.modes)
        if point.degree is not None:
            walls = study.rail_compliance(study.condition(condition), degree=point.degree)
            candidate = candidate._replace(compliance={condition: walls})
        request = candidate.request(study, condition, relative_tolerance=point.setting)
    agreement = None
    if point.degree is not None or point.rung not in _COMPARED:
        error = "unknown" if point.error_deg_s is None else f"{point.error_deg_s:.2g} deg/s"
        agreement = f"not in the agreement table; error {error} on {measured.result.condition} (tipoff cost)"
    return result_of(study, condition, request, quiet, agreement) | {"chosen": found.plain()}


def result_of(
    study: Study, condition: str, request: Run, quiet: bool, agreement: str | None = None
) -> dict:
    """The result of a run. ``agreement``: the error of its model as text, by default that of the
    agreement table."""
    found = study.store.get(request)
    numerics = request.numerics
    if agreement is None:
        agreement = kept.words(
            study,
            request.model,
            condition,
            request.calibration,
            getattr(numerics, "modes", AUTO),
            own_numerics(numerics) if request.model == COMPLIANT else "",
        )
    moved = None
    if request.fidelity == "lowfi" and found.outcome.rate is not None:
        moved = disturbed.kept(study.store, request, found, study.settings.clearance_change)
    made = Single(
        **vars(row(condition, found, study.relative(study.store.path(request)), request)),
        implausible=tuple(request.scene.warnings),
        agreement=agreement,
        disturbed=moved,
        failed=tuple(failure(condition, request, found)),
    )
    if not quiet:
        print("\n".join(lines(made, model(request), study)))
    return asdict(made)


def own_numerics(numerics: Numerics) -> str:
    """Degree and cells as text, where they are not those of the default."""
    found = [f"degree {numerics.degree}"] if numerics.degree not in (None, DEGREE) else []
    if numerics.cells != Numerics().cells:
        found.append(f"{numerics.cells} cells")
    return " and ".join(found)


def ranged(study: Study, condition: str, quiet: bool = False) -> dict:
    """``spread``: the ranges of a condition under the random errors of the scene (``nominal.spread``);
    prints them unless ``quiet``."""
    from tipoff.studies.nominal import page, spread

    found = spread.of(study, study.condition(condition))
    if not quiet:
        print("\n".join(f"  {line}" for line in page.ranges(found)))
    return {"spread": found and asdict(found)}


def require_export(study: Study, export: tuple[str, Path]) -> None:
    """Raise SceneError if the format and file of an ``export`` do not fit the conditions."""
    names = list(study.conditions)
    if len(names) != 1:
        raise SceneError([Fault("--export", "conditions", f"{len(names)}", "one condition")])
    hand_over.require(export[0], study.condition(names[0]).resolved())


def export(study: Study, condition: str, found: dict, export: tuple[str, Path]) -> None:
    """Write the state at exit of the run ``found``; prints the file and what is assumed."""
    kind, path = export
    outcome = Trajectory.load(study.path(found["trajectory"])).outcome
    rail = hand_over.write(kind, path, study.condition(condition).resolved(), outcome)
    say("\n".join(hand_over.words(rail, path)))


def model(request: Run) -> str:
    """The model of a run with its numerics."""
    if request.fidelity == "highfi":
        return f"{FINITE_ELEMENTS}, {1e3 * request.numerics.element_size:g} mm"
    found = words.model(request.scene, request.calibration is not None, request.compliance)
    modes = request.numerics.count
    return found + (
        f", {words.counted(modes, 'mode')} of each rail"
        if modes and request.model == COMPLIANT
        else ""
    )


def lines(row: Single, made_with: str, study: Study) -> list[str]:
    """A run as lines of text with units."""
    said = f" ({row.message})" if row.message else ""
    text = [f"{study.scene.name} / {row.condition}, model {made_with}: {row.status}{said}"]
    if row.thrust:
        text.append(f"  thrust        {row.thrust['text']}")
    text += _stop(study.condition(row.condition))
    if row.advice and not row.failed:
        text.append(f"  advice        {row.advice}")
    if row.exit_time_s is not None:
        text.append(f"  exit          {duration(row.exit_time_s, 4)} after ignition{_after(row)}")
    text += _answer(row)
    text += _stress(row)
    if row.disturbed:
        limit = verdicts.gates(study.scene).settled_rate_error_deg_s
        text += disturbed.lines(row.disturbed, limit)
    if why := row.numerics.get("modes_why"):
        text.append(f"  rail modes    {why}")
    if why := row.numerics.get("degree_why"):
        text.append(f"  degree        {why}")
    if row.rail_compliance:
        text.append(f"  rails         {row.rail_compliance['words']}")
    text.append(f"  agreement     {row.agreement}")
    text.append(f"  took          {row.wall_s:.3g} s, {row.steps} steps")
    text.append(f"  trajectory    {study.path(row.trajectory)}")
    return text


def _stop(scene: Scene) -> list[str]:
    """How long the payload rests on its stop, without a latch that holds it longer."""
    along = launch.of(scene)
    left = stop.release_time(along)
    if not stop.is_there(along) or along.latched == left > 0.0:
        return []
    until = f"until {duration(left, 4)}: then" if math.isfinite(left) else "to the end: never"
    weight = f"the thrust exceeds its weight along the rail, {stop.weight(along):.4g} N"
    return [f"  stop          the payload rests on a stop behind it {until} {weight}"]


def _after(row: ConditionRun) -> str:
    share = row.impulse_after_exit
    return "" if share is None else f", {100.0 * share:.3g} % of the impulse after it"


def _answer(row: ConditionRun) -> list[str]:
    """Velocity and rates at the instant that counts, and before them or after them those at the other
    one."""
    at_exit = row.at == instant.EXIT
    where = f", {instant.where(row.at)}" if at_exit else ""
    text = [] if at_exit and row.taken else _at_exit(row)
    if (found := row.taken) is not None:
        rates = ", ".join(map(uncertain, found.rate_deg_s))
        total = uncertain(math.hypot(*found.rate_deg_s))
        text += [
            f"  velocity      {_vector(found.velocity_m_s)} m/s (x, y, z){where}",
            f"  rate          {rates} deg/s (x, y, z), {total} in total{where}",
            *([] if at_exit else _by_hand(row)),
            f"  direction     {found.direction_error_deg:.4g} deg off axis, "
            f"{1e3 * found.lateral_velocity_m_s:.4g} mm/s across",
        ]
    if at_exit and row.settled is not None:
        rates = ", ".join(map(uncertain, row.settled.rate_deg_s))
        text += [
            f"  burnt out     {rates} deg/s (x, y, z), {_vector(row.settled.velocity_m_s)} m/s, "
            f"{instant.IN_A_VACUUM}",
            *_by_hand(row),
        ]
    return text


def _by_hand(row: ConditionRun) -> list[str]:
    """The settled rates by hand."""
    if row.by_hand is None:
        return []
    rates = ", ".join(map(uncertain, row.by_hand.rate_deg_s))
    return [f"  by hand       {rates} deg/s: {row.by_hand.words}"]


def _at_exit(row: ConditionRun) -> list[str]:
    """Speed and rates at exit, or why they are not known; nothing without an exit."""
    if row.exit_time_s is None:
        return []
    if row.at_exit is None:
        return [f"  at exit       not known: {row.no_exit_values}"]
    rates = ", ".join(map(uncertain, row.at_exit.rate_deg_s))
    speed = uncertain(row.at_exit.velocity_m_s[0], least=1e-4)
    return [f"  at exit       {rates} deg/s (x, y, z), v_x {speed} m/s"]


def _vector(values: Sequence[float]) -> str:
    return ", ".join(uncertain(value, least=1e-4) for value in values)


def _stress(row: ConditionRun) -> list[str]:
    if row.peak_stress_pa is None or row.peak_stress_time_s is None:
        return []
    place = ", ".join(f"{1e3 * value + 0.0:.4g}" for value in row.peak_stress_place_m or ())
    return [
        f"  peak stress   {1e-6 * row.peak_stress_pa:.4g} MPa (von Mises) at x, y, z = "
        f"{place} mm, rail {row.peak_stress_rail}, "
        f"{duration(row.peak_stress_time_s, 4)} after ignition",
        *(f"  warning       {warning}" for warning in row.warnings),
    ]
