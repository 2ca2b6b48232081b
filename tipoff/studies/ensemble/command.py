"""``tipoff ensemble``."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.asked import guarded, study_of
from tipoff.studies.commands.options import (
    CalibrationFile,
    Json,
    Modes,
    Out,
    Sampling,
    SceneName,
    Set,
    Surrogate,
    Workers,
)


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(ensemble)


def ensemble(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    vary: Annotated[
        str,
        typer.Option(
            "--vary",
            metavar="NAME_OR_FILE",
            help="Distributions: a .toml file, or from the catalogue.",
        ),
    ] = "paper",
    table: Annotated[
        Path | None,
        typer.Option(
            "--table", metavar="FILE", help="CSV table of cases, in place of distributions."
        ),
    ] = None,
    cases: Annotated[
        int | None,
        typer.Option(
            "--cases", metavar="N", min=1, help="Number of cases; default: as the file says."
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed", metavar="N", min=0, help="Seed of all draws; default: as the file says."
        ),
    ] = None,
    sampling: Annotated[
        Sampling | None,
        typer.Option("--sampling", help="How points are drawn; default: as the file says."),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option(
            "--store",
            metavar="DIR",
            help="Folder of the results; default: one of its own for every ensemble.",
        ),
    ] = None,
    case: Annotated[
        int | None,
        typer.Option("--case", metavar="N", min=0, help="Run case N alone and print it."),
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance",
            metavar="X",
            help="Relative error of a step; 1e-2 keeps "
            "95 % of 20 reference cases to 0.2 % of their rate, 1e-4 to 0.1 %.",
        ),
    ] = 1e-2,
    model: Surrogate = None,
    modes: Modes = None,
    calibration: CalibrationFile = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Dask scheduler whose workers run the cases, such as tcp://node1:8786.",
        ),
    ] = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Run the surrogate on thousands to millions of varied cases; writes ensemble.json and a store
    in zarr.

    A file of distributions says what varies; --cases, --seed and --sampling may say otherwise:

      \\[vary."payload.mass"]
      distribution = "normal"
      mean = "9.9 kg"
      sd = "20 g"

    The others are fixed (value), uniform (low, high), truncated-normal (mean, sd, low, high, rule
    "redraw" or "clip") and rayleigh (scale). A table has dotted keys in its first line, units in
    the second or in each cell, and one case in every further line.

      tipoff ensemble --cases 1000000
      tipoff ensemble --vary my_errors.toml --sampling sobol --cases 4096
      tipoff ensemble --table cases.csv --store out/night
      tipoff ensemble --cases 1000000 --case 1234    # that case alone, beside its stored bits

    Stopped, killed or out of disk, the same command goes on from there to the same bits. A bad case
    is refused by itself and listed with its inputs and the reason in the store (done/*.json).
    xarray.open_zarr(STORE + "/cases.zarr") reads the results.
    """

    def work() -> dict:
        from tipoff.studies.core import models
        from tipoff.studies.ensemble import stage

        chosen = models.Options(model and model.value, calibration, modes)
        models.require(chosen)
        options = stage.Options(
            vary,
            table,
            cases,
            seed,
            sampling and sampling.value,
            store,
            tolerance,
            scheduler,
            workers,
            chosen,
        )
        study = study_of(scene, out, set_)
        return stage.run(study, options) if case is None else stage.case(study, options, case)

    def lines(found: dict) -> list[str]:
        from tipoff.studies.ensemble import stage, summary

        return summary.lines(found) if case is None else stage.case_lines(found)

    guarded(work, json_, lines)
