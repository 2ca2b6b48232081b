"""``tipoff paper``."""

from typing import Annotated

import typer

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command(without=["element_size"])
def paper(
    request: Request,
    starts: Annotated[
        int,
        typer.Option(
            "--starts",
            metavar="N",
            min=1,
            help="Number of searches over three conditions, and as many over all five; each takes "
            "some minutes.",
        ),
    ] = 3,
) -> Output:
    """Infer inputs that the paper does not print from its rates, and compare its tables with ours.

    Writes paper.json, paper.nc with the end of every search and all admissible points, and the best
    set as paper_like.toml.

    The size of the pads and the platform are those of the scene. After an interruption the same
    command continues with the next search.
    """
    from tipoff.studies.paper import page, stage

    found = stage.run(request.study(), stage.Options(starts))
    return Output(found, page.terminal, request.out)
