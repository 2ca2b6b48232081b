"""``tipoff paper``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import Json, Out, SceneName, Set, Workers
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(paper)


def paper(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    starts: Annotated[
        int,
        typer.Option(
            "--starts",
            metavar="N",
            min=1,
            help="Number of searches over three conditions, and as many over all five; each takes "
            "some minutes.",
        ),
    ] = 3,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Infer inputs that the paper does not print from its rates, and compare its tables with ours.

    Writes paper.json, paper.nc with the end of every search and all admissible points, and the best
    set as paper_like.toml.

    The size of the pads and the platform are those of the scene. After an interruption the same
    command continues with the next search.
    """

    def work() -> dict:
        from tipoff.studies.paper import stage

        return stage.run(study_of(scene, out, set_, workers=workers), stage.Options(starts))

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.paper import page

        return page.terminal(found)

    guarded(work, json_, shown, out)
