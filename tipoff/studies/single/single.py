"""One run of one condition in one model."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path

from pydantic import TypeAdapter

from tipoff.faults import Fault, InputError, SceneError
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.mechanics.rail_compliance import DEGREE
from tipoff.results import hand_over
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import catalog
from tipoff.studies.agreement import kept
from tipoff.studies.calibration.files import constants
from tipoff.studies.runs.results import ConditionRun
from tipoff.studies.runs.stage import failure, row
from tipoff.studies.single import text
from tipoff.studies.single.text import Detail, Single
from tipoff.workspace import disturbed, model_error, models, words
from tipoff.workspace.attempt import attempt
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study, StudyError

_LONG = 3.0  # s of a run, after which its answer comes before the runs for its error
_COMPARED = (
    "highfi",
    "uncalibrated",
    "calibrated",
    "compliant",
    "modal",
)  # rungs of tipoff compare


def run(
    study: Study,
    condition: str,
    options: models.ModelOptions = models.ModelOptions(),
    detail: Detail = Detail.ANSWER,
) -> dict:
    """The result of the run, as in the result file of a stage; prints it in ``detail``.

    Raises SceneError for an unreadable calibration and for options of another model, StudyError if
    no model is named and the agreement table rejects the default on ``condition``.
    """
    fitted = constants(options.calibration, options.model, study.scene.name)
    scene = study.condition(condition)
    if options.model == FINITE_ELEMENTS:
        return result_of(study, condition, study.highfi(condition), detail)
    if options.model == SPRINGS:
        return result_of(study, condition, study.lowfi(condition, fitted), detail)
    kept.require_accepted(study, options.name, condition)
    # checks the numerics before the rail compliance is computed
    vibrating = study.lowfi(condition, fitted, **options.numerics)
    if scene.contact is None:
        return result_of(study, condition, vibrating, detail)
    found = study.rail_compliance(scene, degree=vibrating.numerics.needed_degree)
    request = study.lowfi(condition, fitted, compliance=found, **options.numerics)
    return result_of(study, condition, request, detail)


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
    study: Study,
    condition: str,
    accuracy: float | None,
    budget: float | None,
    detail: Detail = Detail.ANSWER,
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
    return result_of(study, condition, request, detail, agreement) | {"chosen": found.plain()}


def result_of(
    study: Study, condition: str, request: Run, detail: Detail, agreement: str | None = None
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
    moved = error = None
    path = study.relative(study.store.path(request))
    if request.fidelity == "lowfi" and found.outcome.rate is not None:
        waits = found.cost["wall_s"] > _LONG or _waits_for_uncertainty(request)
        if waits and not model_error.is_kept(study.store, request):
            say(text.first(row(condition, found, path)))
        moved = disturbed.kept(study.store, request, found, study.settings.clearance_change)
        error = model_error.kept(study.store, request, found, moved)
    made = Single(
        **vars(row(condition, found, path, request)) | {"range": error and error.range},
        implausible=tuple(request.scene.warnings),
        agreement=agreement,
        disturbed=moved,
        error=error,
        failed=tuple(failure(condition, request, found)),
    )
    if detail:
        print("\n".join(text.lines(made, model(request), study, detail)))
    return asdict(made) | {"error": error and error.plain()}


def _waits_for_uncertainty(request: Run) -> bool:
    return request.compliance is not None and request.compliance.find_uncertainty is not None


def own_numerics(numerics: Numerics) -> str:
    """Degree and cells as text, where they are not those of the default."""
    found = [f"degree {numerics.degree}"] if numerics.degree not in (None, DEGREE) else []
    if numerics.cells != Numerics().cells:
        found.append(f"{numerics.cells} cells")
    return " and ".join(found)


def ranged(study: Study, condition: str, detail: Detail = Detail.ANSWER) -> dict:
    """``spread``: the ranges of a condition under the random errors of the scene (``nominal.spread``);
    prints them unless the ``detail`` is nothing."""
    from tipoff.studies.nominal import page, spread
    from tipoff.studies.render import document

    found = spread.of_scene(study, study.condition(condition))
    if detail:
        print(document.terminal(page.ranges(found)))
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
