"""``tipoff sweeps``."""

from typing import Annotated

import typer

from tipoff.studies.commands.options import Surrogate
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def sweeps(
    request: Request,
    angles: Annotated[
        int, typer.Option("--angles", metavar="N", help="Number of directions for each size.")
    ] = 120,
    model: Surrogate = None,
) -> Output:
    """Vary size and direction of misalignment, thrust eccentricity and mass eccentricity, up to 1 deg
    and 1 mm; writes sweeps.json.

    The result states whether the largest rate about each axis stops growing, and at which size, with
    an interval. The sweep is repeated with a thrust that continues after the exit, or ends before it.
    """
    from tipoff.studies.sweeps import page, stage

    options = stage.Options(angles, model and model.value)
    return Output(stage.run(request.study(), options), page.summary, request.out)
