"""Options of ``tipoff ensemble``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import (
    At,
    CalibrationFile,
    Export,
    Modes,
    Surrogate,
    Vary,
    rate_limits,
)

if TYPE_CHECKING:
    from tipoff.workspace import models


@dataclass(frozen=True)
class EnsembleOptions:
    """None: from the file of distributions, or the default. The file is ``vary``, or the errors
    that the scene states, or the errors of the paper."""

    vary: Vary = None
    table: Annotated[
        Path | None,
        typer.Option(
            "--table", metavar="FILE", help="CSV table of cases, instead of distributions."
        ),
    ] = None
    cases: Annotated[
        int | None,
        typer.Option(
            "--cases", metavar="N", min=1, help="Number of cases; default: from the file."
        ),
    ] = None
    store: Annotated[
        Path | None,
        typer.Option(
            "--store",
            metavar="DIR",
            help="Folder of the results; default: a separate one for every ensemble.",
        ),
    ] = None
    case: Annotated[
        int | None,
        typer.Option("--case", metavar="N", min=0, help="Run case N alone and print its result."),
    ] = None
    sensitivity: Annotated[
        bool,
        typer.Option(
            "--sensitivity",
            help="Also run each case with 1 µm more of every clearance, and at a tolerance of 1e-10. "
            "The result is the change of its settled rates. The runs at 1e-10 take about 20 times as "
            "long as the cases at the default --tolerance.",
        ),
    ] = False
    halve: Annotated[
        bool,
        typer.Option(
            "--halve",
            help="Also run the cases with each tolerance halved in turn, on the same draws. The result is the "
            "change of the 95 % quantile of the total rate, and of the probability above --limit.",
        ),
    ] = False
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance",
            metavar="X",
            help="Relative error of a step. Alone it changes the rates of 95 % of reference cases by less "
            "than 0.2 % with 1e-2, and 0.1 % with 1e-4; above 2e-7 a case also has fewer contact cells and "
            "patterns than tipoff run, which change 95 % of them by up to 1.3 %.",
        ),
    ] = 1e-2
    model: Surrogate = None
    modes: Modes = None
    at: At = None
    limits: Annotated[
        tuple[str, ...],
        rate_limits("10 deg/s", "The result is the probability above any of them."),
    ] = ()
    export: Export = None
    calibration: CalibrationFile = None
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Dask scheduler whose workers run the cases, such as tcp://node1:8786.",
        ),
    ] = None

    def require_one(self) -> None:
        """Raise SceneError for options that say nothing on one case, every fault listed."""
        from tipoff.faults import Fault, SceneError

        given = {
            "--at": self.at,
            "--limit": ", ".join(self.limits),
            "--export": " ".join(map(str, self.export or ())),
            "--scheduler": self.scheduler,
            "--halve": "yes" if self.halve else "",
        }
        expected = "none with --case, which prints one case with all its values"
        faults = [Fault(name, "option", value, expected) for name, value in given.items() if value]
        if faults:
            raise SceneError(faults)

    @property
    def chosen(self) -> "models.ModelOptions":
        """The options of the model."""
        from tipoff.workspace import models

        return models.ModelOptions(self.model, self.calibration, self.modes)
