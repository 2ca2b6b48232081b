"""Options of ``tipoff blind``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import Neighbours, Vary


@dataclass(frozen=True)
class Options:
    """``seed`` None: the digest of the code and the scene; ``neighbours`` None: those of the settings."""

    cases: Annotated[
        int,
        typer.Option(
            "--cases",
            metavar="N",
            min=1,
            help="Number of conditions. Each needs several runs of the reference. A condition that is "
            "judged as a distribution also needs runs of its neighbours.",
        ),
    ] = 8
    vary: Vary = None
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="N",
            min=0,
            help="Seed of the draws; default: a digest of the sources and the scene.",
        ),
    ] = None
    neighbours: Neighbours = None
