"""Stage ``calibration``: constants of springs, fitted to the reference on the fitted conditions.
The compliance of compliant contact is from statics (``studies.calibration.compliance``).

Curves of another code or of a test can replace the reference, for a fit of either surrogate. This result
has a separate folder, because other stages compare with the fit to the reference.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from tipoff.comparison.layout import OF_THE_FORMAT, Layout, of_options
from tipoff.faults import Fault, SceneError
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.names import NOMINAL
from tipoff.studies.calibration import compliance, forecast
from tipoff.workspace.progress import Board, say
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError, picked, require_success

FILE = "calibration.toml"
_OF_COMPLIANT = f"calibration-{COMPLIANT}"


Ends = tuple[float | None, float | None]  # of an interval; None if the curves do not determine it


@dataclass(frozen=True, kw_only=True)
class Fit:
    """A ``scenes.Calibration`` as a result: ``fitted`` are always the values of the intervals;
    ``calibration`` is its file in the folder of the scene."""

    constants: dict[str, float]
    changes: dict[str, float]
    verdict: str
    parameters: list[str]
    values: list[float]  # SI, in the order of the parameters
    fitted: list[float]
    intervals: list[Ends]
    with_model_error: list[Ends]
    units: list[str]
    lower: list[float]
    upper: list[float]
    justification: list[str]
    information: list[list[float]]
    weak_directions: list[str]
    residuals: dict[str, dict[str, float | None]]
    conditions: list[str]
    objective: float  # at the fitted values
    provenance: dict[str, str]
    calibration: str


def run(study: Study) -> Made[Fit]:
    """The fit of springs; writes ``calibration.toml``."""
    names = study.fitted()
    requested = _requested(study)

    def make() -> tuple[Fit, list[Path]]:
        from tipoff import calibration

        say(f"  {forecast.calibration(study, requested)}")
        references = dict(zip(names, study.store.fill("highfi", requested)))
        require_success(references, "calibrate")
        try:
            return fit(study, references, study.path(FILE))
        except calibration.CalibrationError as fault:
            raise StudyError(f"cannot calibrate: {fault}") from None

    return STAGE.run(study, None, make)


def of_models(study: Study, model: str | None = None) -> dict[str, Made]:
    """Calibrate one ``model`` of the surrogate, None for both: ``compliance`` and ``springs``."""
    if model != COMPLIANT:
        study.fitted()  # raises before the compliance is computed
    found: dict[str, Made] = {} if model == SPRINGS else {"compliance": compliance.run(study)}
    return found if model == COMPLIANT else {**found, "springs": run(study)}


def on_reference(study: Study, model: str, parameters: Sequence[str]) -> Made[Fit]:
    """The fit of the ``model`` compliant, with these ``parameters``, on the reference's
    fitted conditions; writes ``calibration-compliant.toml``. Raises CalibrationError."""
    from tipoff import calibration

    calibration.require_model(study.scene, model, parameters)
    calibration.require_parameters(study.scene, study.fitted(), parameters)
    names, requested = study.fitted(), _requested(study)

    def make() -> tuple[Fit, list[Path]]:
        say(f"  {forecast.calibration(study, requested, COMPLIANT, parameters)}")
        references = dict(zip(names, study.store.fill("highfi", requested)))
        require_success(references, "calibrate")
        return fit(study, references, study.path(f"{_OF_COMPLIANT}.toml"), COMPLIANT, parameters)

    return _other(_OF_COMPLIANT, [item.key for item in requested], parameters, study, make)


def _requested(study: Study) -> list[Run]:
    return [study.highfi(name) for name in study.fitted()]


def _inputs(study: Study, _: None) -> list[str]:
    return [item.key for item in _requested(study)]


STAGE = Stage("calibration", __name__, inputs=_inputs, result=Fit)
stored = STAGE.stored


def _other(
    name: str,
    sources: Any,
    parameters: Sequence[str] | None,
    study: Study,
    make: Callable[[], tuple[Fit, list[Path]]],
) -> Made[Fit]:
    """A fit with a file of another ``name``, from ``sources`` (JSON values)."""
    inputs = [sources, parameters and list(parameters)]
    return replace(STAGE, name=name, inputs=lambda *_: inputs).run(study, None, make)


def constants(study: Study) -> dict:
    """Constants of the last calibration, which may be out of date. Raises KeyError without one."""
    found = picked(study.path("calibration.json"), lambda document: dict(document["constants"]))
    if found is None:
        raise KeyError("calibration.json")
    return found


def named(
    references: list[str], condition: str | None, settled_from: float | None
) -> list[tuple[str, str]]:
    """(condition, path) of each ``NAME=FILE``; a file without a name belongs to ``condition``, else
    to the scene itself.

    Raises SceneError for options that need a file if there is none.
    """
    pairs = [item.partition("=") for item in references]
    unnamed = [name for name, equals, _ in pairs if not equals]
    idle = (
        [("--condition", condition, "a file without a name")] if condition and not unnamed else []
    )
    idle += (
        [("--settled-from", f"{settled_from:g} s", "a file")]
        if settled_from is not None and not pairs
        else []
    )
    if idle:
        raise SceneError(
            [
                Fault(option, given, "no --reference", f"{file} for this option")
                for option, given, file in idle
            ]
        )
    return [
        (name.strip(), path) if equals else (condition or NOMINAL, name)
        for name, equals, path in pairs
    ]


def laid_out(files: list[tuple[str, str]], *texts: Sequence[str] | None) -> dict[str, Layout]:
    """The layout of each file by its condition, from the ``texts`` of --columns, --units, --body,
    --axes and --ignition. Raises SceneError, also for options without a file."""
    options = ("--columns", "--units", "--body", "--axes", "--ignition")
    if not files and (idle := {name: own[0] for name, own in zip(options, texts) if own}):
        words = "a file for this option"
        raise SceneError(
            [Fault(option, text, "no --reference", words) for option, text in idle.items()]
        )
    return of_options([name for name, _ in files], *(own or () for own in texts))


def from_files(
    study: Study,
    files: list[tuple[str, str]],
    settled_from: float | None = None,
    model: str = SPRINGS,
    parameters: Sequence[str] | None = None,
    layouts: Mapping[str, Layout] = MappingProxyType({}),
) -> Made[Fit]:
    """The fit of a ``model``, of these ``parameters`` or the default ones, from files
    (condition, path) that ``Curves.read`` reads in their ``layouts``; writes
    ``curves/calibration.toml``, on compliant contact ``curves/calibration-compliant.toml``.

    Raises SceneError listing every fault of every file, CalibrationError for curves that do not fit
    the scene.
    """
    from tipoff import calibration

    calibration.require_model(study.scene, model, parameters)
    names, references = [name for name, _ in files], {}
    faults = [
        Fault("--reference", name, "twice", "one file for a condition")
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    ]
    for name, path in files:
        try:
            study.condition(name)
            references[name] = calibration.Curves.read(
                path, settled_from, layouts.get(name, OF_THE_FORMAT)
            )
        except SceneError as error:
            faults += error.faults
    if faults:
        raise SceneError(faults)
    if parameters is not None:
        calibration.require_parameters(study.scene, list(references), parameters)

    def make() -> tuple[Fit, list[Path]]:
        say(f"  {forecast.search(study, len(references), model, parameters)}")
        return fit(study, references, study.path(f"{stage}.toml"), model, parameters)

    stage = f"curves/{_OF_COMPLIANT if model == COMPLIANT else 'calibration'}"
    sources = {name: item.source for name, item in references.items()}
    return _other(stage, sources, parameters, study, make)


def fit(
    study: Study,
    references: dict,
    path: Path,
    model: str = SPRINGS,
    parameters: Sequence[str] | None = None,
) -> tuple[Fit, list[Path]]:
    """Fit a ``model``, with these ``parameters`` or the default ones, to ``references`` (condition:
    run or curves) and write the record to ``path``: the result, and the files written. Raises
    CalibrationError."""
    from tipoff import calibration

    calibration.require_model(study.scene, model, parameters)
    with Board("calibrate", 1) as board:
        found = calibration.run(
            study.scene,
            references,
            progress=board.callback("calibrate"),
            compliance=study.rail_compliance(study.condition(next(iter(references))))
            if model == COMPLIANT
            else rigid_walls(study, references),
            workers=study.settings.workers,
            fit=parameters,
        )
        board.finished("calibrate", f"objective {found.objective:.4g}")
    found.save(path)
    return fit_of(found, study.relative(path)), [path]


def rigid_walls(study: Study, names: Iterable[str]) -> RailCompliance | None:
    """Rigid walls with the thermal offset, if one of the conditions ``names`` is warm; all
    conditions have one rail."""
    return next(filter(None, (study.rigid_rails(study.condition(name)) for name in names)), None)


def load(study: Study) -> Calibration:
    """The calibration of this scene; makes it if it is missing."""
    run(study)
    return Calibration.load(study.path(FILE))


def fit_of(found: Calibration, path: str) -> Fit:
    """A calibration in the file ``path`` as a result."""
    changed: dict[str, Any] = {
        "fitted": found.estimates,
        "intervals": _finite(found.intervals),
        "with_model_error": _finite(found.with_model_error),
        "information": np.asarray(found.information).tolist(),
    }
    return Fit(**vars(found) | changed, calibration=path)


def _finite(intervals: list[list[float]]) -> list[Ends]:
    return [
        (low if math.isfinite(low) else None, high if math.isfinite(high) else None)
        for low, high in intervals
    ]
