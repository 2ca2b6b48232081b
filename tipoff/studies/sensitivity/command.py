"""``tipoff sensitivity``."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.options import Surrogate
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def sensitivity(
    request: Request,
    vary: Annotated[
        Path | None,
        typer.Option(
            "--vary",
            metavar="FILE",
            help="Distributions of the uncertain inputs, a .toml file; default: "
            "studies/sensitivity/tolerances.toml.",
        ),
    ] = None,
    points: Annotated[
        int,
        typer.Option(
            "--points",
            metavar="N",
            help="Base points of the Sobol' indices, a power of two. Each base point needs two cases "
            "more than the number of inputs.",
        ),
    ] = 1024,
    seed: Annotated[
        int, typer.Option("--seed", metavar="N", help="Seed of the points and of the bootstrap.")
    ] = 1,
    model: Surrogate = None,
) -> Output:
    """Compute the sensitivity to uncertain inputs: contact constants as in the paper's Table 2, and
    Sobol' indices; writes sensitivity.json.

    A file of tolerances gives the distribution of an input (vary), or of a factor of its nominal
    value (factor):

      \\[factor."friction.dynamic"]
      distribution = "uniform"
      low = "0.75"
      high = "1.25"

      \\[vary."thrust_offset.misalignment.y"]      y and z are components of an offset
      distribution = "normal"
      mean = "0 deg"
      sd = "0.1 deg"
    """
    from tipoff.studies.sensitivity import page, stage

    study = request.study()
    tolerances = None if vary is None else str(vary)
    options = stage.Options(tolerances, points, seed, model and model.value)
    return Output(stage.run(study, options), page.summary, request.out)
