"""Options of ``tipoff sensitivity``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import Surrogate


@dataclass(frozen=True)
class Options:
    """``vary`` None: ``tolerances.DEFAULT``; ``model`` None: the default."""

    vary: Annotated[
        str | None,
        typer.Option(
            "--vary",
            metavar="FILE",
            help="Distributions of the uncertain inputs, a .toml file; default: "
            "studies/sensitivity/tolerances.toml.",
        ),
    ] = None
    points: Annotated[
        int,
        typer.Option(
            "--points",
            metavar="N",
            help="Base points of the Sobol' indices, a power of two. Each base point needs two cases "
            "more than the number of inputs.",
        ),
    ] = 1024
    seed: Annotated[
        int, typer.Option("--seed", metavar="N", help="Seed of the points and of the bootstrap.")
    ] = 1
    model: Surrogate = None
