"""``tipoff run``."""

from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import (
    CalibrationFile,
    Cells,
    CheckpointEvery,
    Degree,
    Export,
    Model,
    Modes,
    condition_names,
)
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output, quantity

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


@scene_command()
def run(
    request: Request,
    condition: Annotated[
        list[str] | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            autocompletion=condition_names,
            help="Named condition. Repeatable, or several with commas. Default: the scene itself.",
        ),
    ] = None,
    all_: Annotated[
        bool,
        typer.Option(
            "--all",
            help="Run each condition of the scene; writes lowfi.json, or highfi.json with --model "
            "finite-elements. Model compliant has its defaults.",
        ),
    ] = False,
    model: Model = None,
    modes: Modes = None,
    degree: Degree = None,
    cells: Cells = None,
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
    range_: Annotated[
        bool,
        typer.Option(
            "--range",
            help="Also print the 95 % range under the random errors of the scene (studies.errors): "
            "4,000 launches of compliant contact, or 16,000 where these are not enough.",
        ),
    ] = False,
    export: Export = None,
    *,
    checkpoint_every: CheckpointEvery = None,
    explain: Annotated[
        bool,
        typer.Option(
            "--explain",
            help="Print all that the answer rests on, each with its effect on the rates: parts of the "
            "error, sensitivity, agreement with the reference, thrust. --json always has it.",
        ),
    ] = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict", help="Refuse implausible values of the scene, instead of a warning."
        ),
    ] = False,
) -> Output:
    """Run one or more conditions in one model; prints velocity and rates after the exit.

    The rates have the error of the model, and a line its largest part. A sensitive run has the range of
    its neighbours. --explain prints all that this rests on. The rail compliance is computed
    once for a rail with its pads. --accuracy and --budget choose a model from the results of tipoff
    cost.

      tipoff run --range
      tipoff run --explain
      tipoff run --condition phi35
      tipoff run --condition phi15,phi35,phi60
      tipoff run --condition phi35 --model finite-elements
      tipoff run --all --model finite-elements
      tipoff run --condition h4 --accuracy "0.1 deg/s"
      tipoff run --condition h4 --modes 20 --degree 3 --cells 16
      tipoff run --export rocketpy exit.json
    """
    from tipoff.faults import Fault, SceneError, together
    from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
    from tipoff.scenes.names import NOMINAL
    from tipoff.studies.runs import page, stage
    from tipoff.studies.single import single, text
    from tipoff.workspace import models

    def shown(found: dict) -> "list[Part]":
        return page.draw(single.rows(found)) if "conditions" in found else []

    def without(options: dict, expected: str) -> None:
        wrong = {name: str(value) for name, value in options.items() if value is not None}
        if wrong:
            raise SceneError(
                [Fault(name, "option", given, expected) for name, given in wrong.items()]
            )

    own = {
        "--model": model,
        "--calibration": calibration,
        "--modes": modes,
        "--degree": degree,
        "--cells": cells,
    }
    switches = {"--range": range_ or None, "--explain": explain or None}
    if all_:
        usual = {"--model": model if model == SPRINGS else None}
        rest = {"--condition": condition and ", ".join(condition), "--export": export}
        flags = {"--accuracy": accuracy, "--budget": budget, **switches}
        expected = "none: --all runs each condition with the defaults of its model"
        without(own | usual | rest | flags, expected)
        models.require(models.ModelOptions(model), checkpoint_every=checkpoint_every)
        fidelity = "highfi" if model == FINITE_ELEMENTS else "lowfi"
        every = request.study(checkpoint_every=checkpoint_every, strict=strict)
        made = stage.run(every, fidelity)
        return Output.of(made, lambda runs: page.draw(runs.conditions), request.out)
    if range_:
        usual = {"--model": None} if model == COMPLIANT else {}
        chosen = {"--accuracy": accuracy, "--budget": budget}
        expected = "none: --range is that of compliant contact with its defaults"
        without(own | chosen | usual, expected)
    options = models.ModelOptions(model, calibration, modes, degree, cells)
    detail = text.Detail.ALL if explain else text.Detail.ANSWER
    if request.json_:
        without({"--explain": explain or None}, "none: --json has all")
        detail = text.Detail.NOTHING
    study = request.study(condition or [NOMINAL], checkpoint_every=checkpoint_every, strict=strict)
    names = list(study.conditions)

    if export:
        single.require_export(study, export)

    def ranged(name: str, found: dict) -> dict:
        if export and not found["failed"]:
            single.export(study, name, found, export)
        return found | (single.ranged(study, name, detail) if range_ else {})

    if accuracy is None and budget is None:
        models.require(options, checkpoint_every=checkpoint_every)
        found = single.several(
            names, lambda name: ranged(name, single.run(study, name, options, detail))
        )
        return Output(found, shown)
    without(own, "none: --accuracy and --budget choose the model")
    error, wall = together(
        lambda: quantity("--accuracy", accuracy, "deg/s", "0.1 deg/s"),
        lambda: quantity("--budget", budget, "s", "2 s"),
    )
    found = single.several(
        names, lambda name: ranged(name, single.chosen(study, name, error, wall, detail))
    )
    return Output(found, shown)
