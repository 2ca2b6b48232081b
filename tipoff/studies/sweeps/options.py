"""Options of ``tipoff sweeps``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import At, Surrogate
from tipoff.workspace.options import between

FEWEST = 8  # smallest number of directions that separates the walls


@dataclass(frozen=True)
class Options:
    """``model`` and ``at`` None: the default."""

    angles: Annotated[
        int,
        between(FEWEST),
        typer.Option("--angles", metavar="N", help="Number of directions for each size."),
    ] = 120
    model: Surrogate = None
    at: At = None
