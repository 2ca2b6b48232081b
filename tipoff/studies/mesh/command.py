"""``tipoff mesh``."""

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    SceneName,
    Set,
)
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Add the command to ``app``."""
    app.command()(mesh)


def mesh(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    element_size: ElementSize = None,
    json_: Json = False,
) -> None:
    """Mesh the rails for the reference; writes mesh.json (size, surfaces, quality) and mesh.vtu."""

    def work() -> dict:
        from tipoff.studies.mesh import stage

        return stage.run(study_of(scene, out, set_, element_size=element_size))

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.mesh import page

        return [page.surfaces(found)]

    guarded(work, json_, shown, out)
