"""Options of ``tipoff compare``: of the conditions of the scene, and of blind ones."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import Neighbours, Vary

CASES = 8  # blind conditions of a report


@dataclass(frozen=True)
class CompareOptions:
    """``cases`` None: those of a report, or none for ``tipoff compare``; ``seed`` None: the digest of
    the code and the scene; ``neighbours`` of each condition that is judged as a distribution, None:
    those of the settings. Only ``neighbours`` belongs to the conditions of the scene."""

    cases: Annotated[
        int | None,
        typer.Option(
            "--blind",
            metavar="N",
            min=1,
            help="Compare on N random conditions in place of those of the scene; writes blind.json. Each "
            "needs several runs of the reference. A condition that is judged as a distribution also needs "
            "runs of its neighbours.",
        ),
    ] = None
    vary: Vary = None
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="N",
            min=0,
            help="Seed of --blind; default: a digest of the sources and the scene.",
        ),
    ] = None
    neighbours: Neighbours = None
