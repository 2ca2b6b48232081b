"""``tipoff convergence``."""

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    RefinedCondition,
    SceneName,
    Set,
    Workers,
)
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(convergence)


def convergence(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: RefinedCondition = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Error of the reference by mesh, step, interface stiffness and contact cells; takes minutes;
    writes convergence.json."""

    def work() -> dict:
        from tipoff.studies.convergence import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size, workers=workers), condition
        )

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.convergence import page

        return page.terminal(found)

    guarded(work, json_, shown, out)
