"""``tipoff highfi``, ``tipoff lowfi`` and ``tipoff run``."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import (
    CalibrationFile,
    CheckpointEvery,
    Conditions,
    ElementSize,
    Json,
    Model,
    Modes,
    Out,
    Resume,
    SceneName,
    Set,
    StepEverything,
    Workers,
    condition_names,
)
from tipoff.studies.commands.running import guarded, quantity, study_of

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Add the commands that run every condition to ``app``."""
    app.command()(highfi)
    app.command()(lowfi)


def add_run(app: typer.Typer) -> None:
    """Add the command of a single run to ``app``."""
    app.command()(run)


def highfi(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Conditions = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    checkpoint_every: CheckpointEvery = None,
    resume: Resume = True,
    step_everything: StepEverything = False,
    json_: Json = False,
) -> None:
    """Run the finite-element reference on every condition; writes highfi.json and a netCDF file
    each."""

    def study() -> "Study":
        return study_of(
            scene,
            out,
            set_,
            condition,
            element_size,
            workers,
            checkpoint_every,
            resume,
            step_everything=step_everything,
        )

    _run("highfi", study, json_, out)


def lowfi(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Conditions = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Run the surrogate, model compliant, on every condition; writes lowfi.json and a netCDF file
    each."""

    def study() -> "Study":
        return study_of(scene, out, set_, condition, element_size, workers)

    _run("lowfi", study, json_, out)


def _run(fidelity: str, study: Callable[[], "Study"], as_json: bool, out: Path) -> None:
    def work() -> dict:
        from tipoff.studies.runs import stage

        return stage.run(study(), fidelity)

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.runs import page

        return [page.settled(found["conditions"])]

    guarded(work, as_json, shown, out)


def run(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Annotated[
        list[str] | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            autocompletion=condition_names,
            help="Named condition, repeatable, or several with commas; default: the scene itself.",
        ),
    ] = None,
    model: Model = None,
    modes: Modes = None,
    calibration: CalibrationFile = None,
    accuracy: Annotated[
        str | None,
        typer.Option(
            "--accuracy",
            metavar="RATE",
            help="Largest error of the settled rates, "
            '"0.1 deg/s": chooses the fastest model within it, as measured by tipoff cost.',
        ),
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option(
            "--budget",
            metavar="TIME",
            help='Largest wall time, "2 s": chooses the '
            "most accurate model within it, as measured by tipoff cost.",
        ),
    ] = None,
    element_size: ElementSize = None,
    checkpoint_every: CheckpointEvery = None,
    resume: Resume = True,
    json_: Json = False,
) -> None:
    """Run one condition or several in one model and print velocity and rates after the exit.

    The output names the model and, after tipoff compare, its error. The rail compliance is computed
    once for a rail with its pads. --accuracy and --budget choose a model from the results of tipoff
    cost.

      tipoff run --condition phi35
      tipoff run --condition phi15,phi35,phi60
      tipoff run --condition phi35 --model finite-elements
      tipoff run --condition h4 --accuracy "0.1 deg/s"
    """

    def work() -> dict:
        from tipoff.scenes.faults import Fault, SceneError
        from tipoff.studies.core import models
        from tipoff.studies.core.checked import together
        from tipoff.studies.runs import single

        options = models.Options(model and model.value, calibration, modes)
        study = study_of(
            scene,
            out,
            set_,
            condition or ["nominal"],
            element_size,
            checkpoint_every=checkpoint_every,
            resume=resume,
        )
        names = list(study.conditions)
        if accuracy is None and budget is None:
            models.require(options, checkpoint_every=checkpoint_every)
            return single.several(names, lambda name: single.run(study, name, options, json_))
        given = {"--model": model, "--calibration": calibration, "--modes": modes}
        if wrong := [name for name, value in given.items() if value is not None]:
            raise SceneError(
                [
                    Fault(name, "option", "given", "none: --accuracy and --budget choose the model")
                    for name in wrong
                ]
            )
        error, wall = together(
            lambda: quantity("--accuracy", accuracy, "deg/s", "0.1 deg/s"),
            lambda: quantity("--budget", budget, "s", "2 s"),
        )
        return single.several(names, lambda name: single.chosen(study, name, error, wall, json_))

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.runs import page

        return [page.settled(found["conditions"])] if "conditions" in found else []

    guarded(work, json_, shown)
