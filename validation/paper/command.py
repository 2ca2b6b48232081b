"""``python -m validation paper``."""

from typing import Annotated

import typer

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def paper(
    request: Request,
    starts: Annotated[
        int,
        typer.Option(
            "--starts",
            metavar="N",
            min=1,
            help="Number of searches over three conditions, and of searches over all five. Each "
            "takes some minutes.",
        ),
    ] = 3,
) -> Output:
    """Infer unpublished inputs of the paper from its rates, and compare its tables with ours.

    Writes paper.json and paper.nc, which has the end of every search and all admissible points. The
    best set of inputs is written as paper_like.toml.

    The size of the pads and the platform are taken from the scene. After an interruption the same
    command continues with the next search.
    """
    from validation.paper import page, stage

    found = stage.run(request.study(), stage.PaperOptions(starts))
    return Output.of(found, page.draw, request.out)
