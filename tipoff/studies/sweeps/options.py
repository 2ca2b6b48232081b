"""Options of ``tipoff sweeps``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import At, Surrogate, errors_file
from tipoff.workspace.options import between

FEWEST = 8  # smallest number of directions that separates the walls


@dataclass(frozen=True)
class Options:
    """``vary`` None: every error up to 1 deg or mm; ``model`` and ``at`` None: the default."""

    vary: Annotated[str | None, errors_file("each error up to 1 deg or 1 mm")] = None

    angles: Annotated[
        int,
        between(FEWEST),
        typer.Option("--angles", metavar="N", help="Number of directions for each size."),
    ] = 120
    model: Surrogate = None
    at: At = None
