"""``tipoff droptest``: logs of drop tests compared with simulated cases."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.options import SeedOfFile, Surrogate, Vary, condition_names
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def droptest(
    request: Request,
    logs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[LOG.toml]...",
            help="Sheets of logs; default: the three simulated logs of the package.",
        ),
    ] = None,
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            autocompletion=condition_names,
            help="Named condition of the drop test; default: the scene.",
        ),
    ] = None,
    vary: Vary = "paper",
    cases: Annotated[
        int, typer.Option("--cases", metavar="N", min=50, help="Simulated cases to compare with.")
    ] = 1000,
    seed: SeedOfFile = None,
    model: Surrogate = None,
) -> Output:
    """Compute the change of rate in drop tests, its uncertainty, and its rank among simulated cases.

    Writes droptest.json, all signals to droptest.nc, and figures.

    A log is a CSV file with time and three rates; accelerations and temperature are optional. Its
    sheet is a .toml file in the same folder with units, axes, calibration and uncertainties.
    studies/droptest/logs/ has three examples. The arguments are the sheets:

      tipoff droptest test1.toml test2.toml test3.toml

    The simulated cases have the random errors of the paper. --vary replaces them:

      tipoff droptest test1.toml --scene my_launcher.toml --vary my_errors.toml --condition heavy

    The logs of the package are simulated by a sensor model. All results mark them as simulated.
    """
    from tipoff.studies.droptest import page, stage

    options = stage.Options(
        tuple(logs) if logs else None, vary, cases, seed, condition, model and model.value
    )
    return Output(stage.run(request.study(), options), page.terminal, request.out)
