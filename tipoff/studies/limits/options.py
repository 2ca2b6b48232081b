"""Options of ``tipoff limits``."""

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from tipoff.studies.commands.options import (
    At,
    Surrogate,
    condition_names,
    errors_file,
    rate_limits,
)
from tipoff.workspace.options import between


@dataclass(frozen=True)
class LimitsOptions:
    """``limits`` in the form of ``exceedance.limits``; ``cases`` None: ten times the fewest;
    ``condition`` None: the scene; ``certify`` None: no run of the reference; ``vary`` None: no file of
    errors; ``model`` and ``at`` None: the default."""

    limits: Annotated[
        tuple[str, ...],
        rate_limits("2 deg/s", "All limits must be kept. Default: 5 deg/s for the total rate."),
    ] = ("5 deg/s",)
    probability: Annotated[
        float,
        between(0.5, below=1.0),
        typer.Option(metavar="P", help="Share of launches that keep all limits."),
    ] = 0.99
    confidence: Annotated[
        float,
        between(0.5, below=1.0),
        typer.Option(metavar="C", help="Confidence level of the probability."),
    ] = 0.95
    cases: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=1,
            help="Cases of each set of tolerances; default: ten times the smallest possible number.",
        ),
    ] = None
    vary: Annotated[
        str | None,
        errors_file(
            "thrust, mass, clearance and friction of the scene, and the set that the paper advises"
        ),
    ] = None
    others: Annotated[
        Literal["scene", "zero"],
        typer.Option(help="Errors that do not vary: values of the scene, or zero."),
    ] = "scene"
    condition: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            autocompletion=condition_names,
            help="Named condition; default: the scene.",
        ),
    ] = None
    certify: Annotated[
        int | None,
        between(20, noun="runs"),  # fewer give no useful bound
        typer.Option(
            metavar="N",
            help="Check the tolerances that are scaled together with N runs of the finite-element "
            "reference. The result is an upper bound of the probability above a limit.",
        ),
    ] = None
    model: Surrogate = None
    at: At = None
