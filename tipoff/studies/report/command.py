"""``tipoff report``."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    SceneName,
    Set,
    Workers,
)
from tipoff.studies.commands.running import guarded, study_of


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(report)


def report(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    every: Annotated[
        bool,
        typer.Option(
            "--every",
            help="Make every study that has no present result first (an hour); one "
            "that the scene gives no occasion for says so on the page.",
        ),
    ] = False,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """All of it on one self-contained page; writes report.html and figures/.

    Makes mesh, highfi, lowfi, calibrate, compare, cost, stability and ablation where they are out
    of date (half an hour the first time); every other study is shown if it was made, or made with
    --every.
    """

    def work() -> dict:
        from tipoff.studies.report import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size, workers=workers), every
        )

    guarded(work, json_)
