"""Stage ``curves``: curves of files, and of tipoff, against those of the first file."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.comparison import metrics
from tipoff.comparison.curves import Curves
from tipoff.comparison.layout import of_options
from tipoff.faults import Fault, SceneError, together
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.names import NOMINAL
from tipoff.studies.calibration.files import constants
from tipoff.studies.commands.running import quantity
from tipoff.studies.curves import page
from tipoff.studies.curves.options import CurvesOptions
from tipoff.studies.curves.results import Channel, Compared, CurveDifference, Drawn
from tipoff.studies.render.document import with_figures
from tipoff.workspace import models as known
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, require_success

NAME = "curves"
_DRAWN = 300  # samples of a curve in the result
_DIFFERENCES = (  # fields of CurveDifference that are fields of a Difference
    "settled_rate_error_deg_s",
    "rate_relative_l2",
    "velocity_relative_l2",
    "iso18571",
    "sprague_geers_magnitude",
    "sprague_geers_phase",
)


def run(study: Study, options: CurvesOptions = CurvesOptions()) -> Made[Compared]:
    """The differences from the files. Raises SceneError listing every fault of every file."""
    curves, _ = together(lambda: _of_files(options), lambda: _require(study, options))
    requests = _requests(study, options)

    def make() -> tuple[Compared, list[Path]]:
        runs = dict(zip(requests, study.store.fill(NAME, list(requests.values()))))
        require_success(runs, "compare curves")
        start = _settled_from(options)
        found = curves | {name: Curves.from_trajectory(one, start) for name, one in runs.items()}
        return with_figures(
            compared(study.scene.name, options, found), page.figures, study.path("figures")
        )

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: CurvesOptions) -> list:
    sources = [item.source for item in _of_files(options).values()]
    return [sources, [request.key for request in _requests(study, options).values()]]


STAGE = Stage(NAME, __name__, options=CurvesOptions, inputs=_inputs, result=Compared)


def _of_files(options: CurvesOptions) -> dict[str, Curves]:
    """The curves of the files by name. Raises SceneError."""
    pairs = [_named(text) for text in options.files or ()]
    names = [name for name, _ in pairs]
    models = [f"tipoff {model}" for model in options.model or ()]
    faults = [
        Fault("FILE", "name", f"{name!r} twice", "NAME=FILE with another NAME for each file")
        for name in dict.fromkeys(names)
        if [*names, *models].count(name) > 1
    ]
    if len(pairs) + len(models) < 2 or not pairs:
        words = "two files, or one file and --model"
        faults.append(Fault("FILE", "files", ", ".join(names) or "nothing", words))
    start = _settled_from(options)
    stated = (options.columns, options.units, options.body, options.axes, options.ignition)
    layouts = of_options(names, *(texts or () for texts in stated))
    found = {}
    for name, path in pairs:
        try:
            found[name] = Curves.read(path, start, layouts[name], optional=("velocity_x",))
        except SceneError as error:
            faults += error.faults
    if faults:
        raise SceneError(faults)
    return found


def _settled_from(options: CurvesOptions) -> float | None:
    return quantity("--settled-from", options.settled_from, "s", "44 ms")


def _named(text: str) -> tuple[str, str]:
    """Name and path of ``NAME=FILE``; without a name that of the file."""
    name, equals, path = text.partition("=")
    return (name.strip(), path) if equals else (Path(text).name, text)


def _require(study: Study, options: CurvesOptions) -> None:
    """Raise SceneError for an unknown model or condition, and for options of runs without one."""
    if options.condition:
        study.condition(options.condition)
    for model in options.model or ():
        known.require(known.ModelOptions(model))
    surrogates = {*(options.model or ())} - {FINITE_ELEMENTS}
    if options.calibration and options.model and len(surrogates) != 1:
        given = ", ".join(options.model)
        expected = "one surrogate, which the file belongs to, with --calibration"
        raise SceneError([Fault("--model", "option", given, expected)])
    idle = {"--condition": options.condition, "--calibration": options.calibration}
    if not options.model and any(idle.values()):
        raise SceneError(
            [
                Fault(option, "option", str(given), "--model for this option")
                for option, given in idle.items()
                if given
            ]
        )


def _requests(study: Study, options: CurvesOptions) -> dict[str, Run]:
    """The runs of tipoff by name. Raises SceneError."""
    models = tuple(dict.fromkeys(options.model or ()))
    name = options.condition or NOMINAL
    fitted = _fitted(study, options.calibration, models)
    made = {}
    for model in models:
        own = fitted.get(model)
        if model == FINITE_ELEMENTS:
            made[f"tipoff {model}"] = study.highfi(name)
        elif model == SPRINGS:
            made[f"tipoff {model}"] = study.lowfi(name, own)
        else:
            under = study.rail_compliance(study.condition(name))
            made[f"tipoff {model}"] = study.lowfi(name, own, compliance=under)
    return made


def _fitted(
    study: Study, path: Path | None, models: Sequence[str]
) -> dict[str, Calibration | None]:
    """The calibration in a file by the surrogate that it belongs to. Raises SceneError."""
    surrogates = [model for model in models if model != FINITE_ELEMENTS] or [COMPLIANT]
    faults: list[Fault] = []
    found: dict[str, Calibration | None] = {}
    for model in surrogates:
        try:
            found[model] = constants(path, model, study.scene.name)
        except SceneError as error:
            faults += error.faults
    if not found:
        raise SceneError(faults)
    return found


def compared(scene: str, options: CurvesOptions, found: dict[str, Curves]) -> Compared:
    """The result of curves by name; the first is the reference."""
    reference, *others = found
    differences = {name: metrics.compare(found[reference], found[name]) for name in others}
    return Compared(
        scene=scene,
        asked=options,
        condition=(options.condition or NOMINAL) if options.model else None,
        reference=reference,
        rows=tuple(_row(name, item, differences.get(name)) for name, item in found.items()),
        ratings=tuple(
            Channel(curve=name, **item.iso18571_channels) for name, item in differences.items()
        ),
        drawn={name: _drawn(item) for name, item in found.items()},
    )


def _row(name: str, curves: Curves, difference: metrics.Difference | None) -> CurveDifference:
    x, y, z = np.degrees(curves.settled).tolist()
    found: dict[str, Any] = {}
    if difference is not None:
        found = {key: getattr(difference, key) for key in _DIFFERENCES}
    return CurveDifference(
        curve=name, settled_rate_deg_s=(x, y, z), settled_from_s=curves.window_start, **found
    )


def _drawn(curves: Curves) -> Drawn:
    keep = np.unique(np.linspace(0, curves.time.size - 1, _DRAWN).round().astype(int))
    known = np.isfinite(curves.velocity).all()
    return Drawn(
        source=curves.source,
        time_s=tuple(curves.time[keep].round(6).tolist()),
        velocity_m_s=tuple(curves.velocity[keep].round(5).tolist()) if known else None,
        rate_deg_s=tuple(map(tuple, np.degrees(curves.rate[keep]).round(4).tolist())),
    )
