"""``python -m validation flights``."""

import os
from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.options import Json, Out
from tipoff.studies.commands.running import Output, guarded


def flights(
    records: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Folder with psas_l12.csv and hedy_2025.csv; default: $TIPOFF_MEASURED.",
        ),
    ] = None,
    cases: Annotated[
        int, typer.Option(metavar="N", min=2, help="Draws for each of four places of the guides.")
    ] = 50,
    out: Out = Path("out"),
    json_: Json = False,
) -> None:
    """Compare two measured launches from rails with the predictions of several models; writes
    flights/flights.json and flights/flights.png.

    The records are public and are not part of the project. The command takes half an hour.
    """

    def work() -> Output:
        from validation.flights import page, record, stage

        folder = records or Path(os.environ.get(record.ROOT, "."))
        return Output(stage.run(folder, out, cases), page.parts)

    guarded(work, json_)
