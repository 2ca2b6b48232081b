"""``tipoff compare``."""

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Neighbours,
    Out,
    SceneName,
    Set,
    Workers,
)
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(compare)


def compare(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    neighbours: Neighbours = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Agreement on fitted and held-out conditions with the floor, and the speed-up; writes
    agreement.json."""

    def work() -> dict:
        from tipoff.studies.agreement import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size, workers=workers),
            None if neighbours is None else stage.Options(neighbours),
        )

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.agreement import page

        return page.terminal(found)

    guarded(work, json_, shown, out)
