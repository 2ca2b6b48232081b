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
    """Add the command to ``app``."""
    app.command()(report)


def report(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    every: Annotated[
        bool,
        typer.Option(
            "--every",
            help="First make every study without a present result (an hour). The page gives the "
            "reason where the scene does not allow one.",
        ),
    ] = False,
    limit: Annotated[
        list[str] | None,
        typer.Option(
            "--limit",
            metavar="[AXIS=]RATE",
            help='Limit of a rate, "x=2 deg/s", or of the total rate, "5 deg/s", that the page '
            "judges; repeatable.",
        ),
    ] = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Show all results on one self-contained page; writes report.html and figures/.

    Makes mesh, highfi, lowfi, calibrate, compare, cost, stability and ablation where they are out
    of date (half an hour the first time). The page shows every other study that has a result;
    --every makes them all.
    """

    def work() -> dict:
        from tipoff.studies.populations import exceedance
        from tipoff.studies.report import stage

        limits = exceedance.limits(limit or [])
        study = study_of(scene, out, set_, element_size=element_size, workers=workers)
        return stage.run(study, every, limits)

    def shown(found: dict) -> list[str]:
        return [found["verdict"]] if found["verdict"] else []

    guarded(work, json_, shown, out)
