"""Stage ``posterior``: what the calibrated constants may be, given that the surrogate is wrong, and what follows for the exit rates
of every condition, fitted or held out."""

import importlib.util

from scenes.calibration import Calibration
from studies.agreement import prediction, verdicts
from studies.agreement.verdicts import Context
from studies.cost import forecast
from studies.progress import Board, say
from studies.stages import calibrate as calibration_stage
from studies.stages import compare
from studies.store import SOURCES
from studies.study import Study, StudyError, read, require_success

NAME = "posterior"


def run(study: Study) -> dict:
    """The posterior as plain values, ``predicted`` rows by condition and ``coverage`` by role. Raises StudyError without emcee."""
    if importlib.util.find_spec("emcee") is None:
        raise StudyError("the posterior is drawn with emcee, which is not installed: pip install 'tipoff[studies]'")
    calibration = calibration_stage.load(study)
    document = study.stage(NAME, _key(study, calibration.constants), lambda: (_made(study, calibration), []))
    for doubt in document["chain"]["doubts"]:
        say(f"  not converged: {doubt}")
    return document


def _made(study: Study, calibration: Calibration) -> dict:
    import calibrate

    roles, workers = _roles(study), study.settings.workers
    asked = {name: study.highfi(name) for name in roles}
    say(f"  {forecast.posterior(study, compare.asked_of_the_reference(study), len(study.fitted()))}")
    references = dict(zip(asked, study.store.fill("highfi", list(asked.values()))))
    require_success(references, "draw a posterior")
    rigid = calibration_stage.rigid_walls(study, asked)
    sure = Context([], compare.refinements(study), verdicts.gates(study.scene))
    with Board(NAME, 2) as board:
        known = {name: references[name] for name in study.fitted()}
        found = calibrate.posterior(study.scene, known, calibration, board.callback("constants"), walls=rigid, workers=workers)
        board.finished("constants", _drawn(found.chain))
        scenes = {name: study.condition(name) for name in asked}
        rates = prediction.rates(found, scenes, workers, board.callback("rates"), rigid)
        rows = [prediction.row(name, roles[name], found, drawn, references[name].outcome.rate,
                               bool(references[name].pad_force.any()), sure.converged(name)) for name, drawn in rates.items()]
        covered = {role: prediction.coverage([row for row in rows if row["role"] == role]) for role in ("fitted", "held_out")}
        board.finished("rates", prediction.covered(covered))
    linear = calibration_stage.as_dict(calibration)["intervals"]
    return found.as_dict() | {"linear": linear, "predicted": rows, "coverage": covered}


def stored(study: Study) -> dict | None:
    """The result, if it was made from the present scene, code, settings and calibration."""
    calibration = read(study.path("calibration.json"))
    return study.stored(NAME, lambda _: _key(study, calibration["constants"])) if calibration else None


def _key(study: Study, constants: dict) -> str:
    return study.key(SOURCES["calibrated"], NAME, constants, [study.highfi(name).key for name in _roles(study)])


def _roles(study: Study) -> dict[str, str]:
    """Fitted or held out, by condition."""
    roles = study.scene.agreement
    return dict.fromkeys([*roles.fitted, *roles.held_out], "held_out") | dict.fromkeys(roles.fitted, "fitted")


def lines(document: dict) -> list[str]:
    """Intervals and coverage in words."""
    columns = zip(*(document[key] for key in ("parameters", "best", "units", "intervals", "without")))
    said = [f"  {name:22}{best:.4g}{'' if unit == '1' else f' {unit}'}, 95 % {_interval(ends)} (noise alone: {_interval(narrow)})"
            for name, best, unit, ends, narrow in columns]
    return [f"posterior of {document['scene']}: {_drawn(document['chain'])}", *said, *(f"  {words}" for words in document["notes"]),
            *(f"  not converged: {words}" for words in document["chain"]["doubts"]),
            f"  {prediction.covered(document['coverage'])}"]


def _interval(ends: list[float] | None) -> str:
    return "not told" if ends is None else f"{ends[0]:.4g} to {ends[1]:.4g}"


def _drawn(chain: dict) -> str:
    return f"{chain['effective']:.0f} independent draws in {chain['steps']} steps of {chain['walkers']} walkers"
