"""``tipoff limits``: the tolerances that keep rates below limits."""

from enum import StrEnum
from typing import Annotated

import typer

from tipoff.studies.commands.options import Seed, Surrogate, condition_names
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


class Tolerances(StrEnum):
    """Sets of tolerances that are scaled together."""

    advised = "advised"
    table3 = "table3"


class Others(StrEnum):
    """Values of the errors that do not vary."""

    scene = "scene"
    zero = "zero"


Limit = Annotated[
    list[str] | None,
    typer.Option(
        "--limit",
        metavar="[AXIS=]RATE",
        help='Limit of a rate, "x=2 deg/s", or of the total rate, "5 deg/s"; repeatable. All '
        "limits must be kept. Default: 5 deg/s for the total rate.",
    ),
]
Probability = Annotated[
    float,
    typer.Option("--probability", metavar="P", help="Share of launches that keep all limits."),
]
Confidence = Annotated[
    float, typer.Option("--confidence", metavar="C", help="Confidence level of the probability.")
]
Cases = Annotated[
    int | None,
    typer.Option(
        "--cases",
        metavar="N",
        min=1,
        help="Cases of each set of tolerances; default: ten times the smallest possible number.",
    ),
]
Scaled = Annotated[
    Tolerances,
    typer.Option(
        "--tolerances",
        help="Tolerances that are scaled together: those that the paper advises, or the ranges of its "
        "Table 3.",
    ),
]
Fixed = Annotated[
    Others,
    typer.Option("--others", help="Errors that do not vary: values of the scene, or zero."),
]
Draws = Annotated[
    int | None,
    typer.Option(
        "--draws",
        metavar="N",
        help="Draws of the calibrated constants from their intervals, with --model springs; "
        "default: 8.",
    ),
]
Condition = Annotated[
    str | None,
    typer.Option(
        "--condition",
        metavar="NAME",
        autocompletion=condition_names,
        help="Named condition; default: the scene.",
    ),
]
Certify = Annotated[
    int | None,
    typer.Option(
        "--certify",
        metavar="N",
        help="Check the tolerances that are scaled together with N runs of the finite-element "
        "reference. The result is an upper bound of the probability above a limit.",
    ),
]


@scene_command()
def limits(
    request: Request,
    limit: Limit = None,
    probability: Probability = 0.99,
    confidence: Confidence = 0.95,
    cases: Cases = None,
    tolerances: Scaled = Tolerances.advised,
    others: Fixed = Others.scene,
    draws: Draws = None,
    condition: Condition = None,
    certify: Certify = None,
    seed: Seed = 1,
    model: Surrogate = None,
) -> Output:
    """Find the largest tolerances of thrust, mass, clearance and friction that keep the rates
    below limits with a probability; writes limits.json.

    The result has each tolerance alone, all tolerances together, and pairs of misalignment and
    mass eccentricity. It includes the uncertainty of the constants and of the model.

      tipoff limits --limit "x=2 deg/s" --limit "5 deg/s" --probability 0.99
      tipoff limits --limit "10 deg/s" --others zero --tolerances table3
      tipoff limits --limit "10 deg/s" --probability 0.95 --certify 200
    """
    from tipoff.studies.limits import page, stage
    from tipoff.studies.limits.inputs import Options

    options = Options(
        tuple(limit or Options.limits),
        probability,
        confidence,
        cases,
        seed,
        tolerances.value,
        others.value,
        draws,
        model and model.value,
        condition,
        certify,
    )
    return Output(stage.run(request.study(), options), page.summary, request.out)
