"""Options of ``tipoff sensitivity``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import At, Surrogate, errors_file
from tipoff.workspace.options import Rule

HALVINGS = 3  # parts of the points, each half of the next, for convergence
_FEWEST = 2**HALVINGS * 8


@dataclass(frozen=True)
class Options:
    """``vary`` None: ``tolerances.DEFAULT``; ``model`` and ``at`` None: the default."""

    vary: Annotated[
        str | None,
        errors_file("studies/sensitivity/tolerances.toml"),
    ] = None
    points: Annotated[
        int,
        Rule(
            lambda value: value >= _FEWEST and not int(value) & (int(value) - 1),
            f"a power of two, {_FEWEST} or more",
        ),
        typer.Option(
            metavar="N",
            help="Base points of the Sobol' indices, a power of two. Each base point needs two cases "
            "more than the number of inputs.",
        ),
    ] = 1024
    model: Surrogate = None
    at: At = None
