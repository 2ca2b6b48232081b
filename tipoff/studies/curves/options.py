"""Options of ``tipoff curves``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import (
    CalibrationFile,
    SettledFrom,
    condition_names,
    of_files,
)


@dataclass(frozen=True)
class CurvesOptions:
    """``files`` None: a fault; ``condition`` None: the scene itself; ``model`` None: only files."""

    files: Annotated[
        tuple[str, ...] | None,
        typer.Argument(
            metavar="[NAME=]FILE...", help="Files with curves; the first is the reference."
        ),
    ] = None
    columns: Annotated[tuple[str, ...] | None, of_files("--columns")] = None
    units: Annotated[tuple[str, ...] | None, of_files("--units")] = None
    body: Annotated[tuple[str, ...] | None, of_files("--body")] = None
    axes: Annotated[tuple[str, ...] | None, of_files("--axes")] = None
    ignition: Annotated[tuple[str, ...] | None, of_files("--ignition")] = None
    settled_from: SettledFrom = None
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            autocompletion=condition_names,
            help="Condition of --model; default: the scene.",
        ),
    ] = None
    model: Annotated[
        tuple[str, ...] | None,
        typer.Option(
            "--model",
            metavar="MODEL",
            help="Model of tipoff to compare as well: compliant, springs or finite-elements. "
            "Repeatable.",
        ),
    ] = None
    calibration: CalibrationFile = None
