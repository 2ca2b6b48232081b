"""Options of ``tipoff measured``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.options import Surrogate, Vary, condition_names


@dataclass(frozen=True)
class MeasuredOptions:
    """``logs`` None: those of the package; ``condition`` None: the scene
    itself; ``model`` None: the default."""

    logs: Annotated[
        tuple[Path, ...] | None,
        typer.Argument(
            metavar="[LOG.toml]...",
            help="Sheets of logs; default: the three simulated logs of the package.",
        ),
    ] = None
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            autocompletion=condition_names,
            help="Named condition of the tests; default: the scene.",
        ),
    ] = None
    vary: Vary = None
    cases: Annotated[
        int, typer.Option("--cases", metavar="N", min=50, help="Simulated cases to compare with.")
    ] = 1000
    model: Surrogate = None
