"""``tipoff droptest``: what logs of drop tests say, and where they sit among simulated cases."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.asked import guarded, study_of
from tipoff.studies.commands.options import Json, Out, SceneName, Set, Surrogate, Workers


def add(app: typer.Typer) -> None:
    """Put the command under ``tipoff``."""
    app.command("droptest")(droptest)


def droptest(
    logs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[LOG.toml]...",
            help="Sheets of logs; default: the three simulated ones that come with the package.",
        ),
    ] = None,
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: Annotated[
        str | None,
        typer.Option(
            "--condition",
            metavar="NAME",
            help="Named condition that was dropped; default: the scene.",
        ),
    ] = None,
    vary: Annotated[
        str, typer.Option("--vary", metavar="NAME_OR_FILE", help="Distributions of the cases.")
    ] = "paper",
    cases: Annotated[
        int, typer.Option("--cases", metavar="N", min=50, help="Simulated cases to compare with.")
    ] = 1000,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed", metavar="N", min=0, help="Seed of all draws; default: as the file says."
        ),
    ] = None,
    model: Surrogate = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """From logs of drop tests to rates with their uncertainty, and their place in the simulated
    distribution.

    Writes droptest.json, all signals to droptest.nc, and figures.

    A log is a CSV file with time, three rates and, if there are, accelerations and temperature.
    Beside it lies a sheet, a .toml file with units, axes, calibration and its uncertainties;
    studies/droptest/logs/ holds three to copy from. Give the sheets:

      tipoff droptest test1.toml test2.toml test3.toml

    The simulated cases have the errors that the paper lists, unless a file says which yours has:

      tipoff droptest test1.toml --scene my_launcher.toml --vary my_errors.toml --condition heavy

    The logs that come with the package are simulated by a sensor model, and say so wherever they
    appear.
    """

    def work() -> dict:
        from tipoff.studies.droptest import stage

        return stage.run(
            study_of(scene, out, set_, workers=workers),
            stage.Options(
                tuple(logs) if logs else None, vary, cases, seed, condition, model and model.value
            ),
        )

    found = guarded(work, json_)
    if not json_:
        folder = Path(out) / found["scene"]
        files = [
            f"  {'data' if path == found['data'] else 'figure':13} {folder / path}"
            for path in found["files"]
        ]
        print("\n".join([*found["summary"], *files]))
