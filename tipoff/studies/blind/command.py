"""``tipoff blind``."""

from typing import Annotated

import typer

from tipoff.studies.commands.options import Neighbours
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def blind(
    request: Request,
    cases: Annotated[
        int,
        typer.Option(
            "--cases",
            metavar="N",
            min=1,
            help="Number of conditions. Each needs several runs of the reference. A condition that is "
            "judged as a distribution also needs runs of its neighbours.",
        ),
    ] = 8,
    vary: Annotated[
        str,
        typer.Option(
            "--vary",
            metavar="NAME_OR_FILE",
            help="Distributions: a .toml file, or a name of the catalogue.",
        ),
    ] = "paper",
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="N",
            min=0,
            help="Seed of the draws; default: a digest of the sources and the scene.",
        ),
    ] = None,
    neighbours: Neighbours = None,
) -> Output:
    """Compare the surrogates with the reference on random conditions, drawn after all constants are
    fixed; writes blind.json."""
    from tipoff.studies.blind import page, stage

    options = stage.Options(cases, vary, seed, neighbours)
    return Output(stage.run(request.study(), options), page.verdicts, request.out)
