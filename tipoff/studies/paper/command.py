"""``tipoff paper``."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.asked import guarded, study_of
from tipoff.studies.commands.options import Json, Out, SceneName, Set, Workers


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
            help="Independent searches for three conditions, "
            "and as many for all five; each takes some minutes.",
        ),
    ] = 3,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """What the inputs the paper does not print must have been, and its tables beside ours.

    Writes paper.json, paper.nc with every end and admissible point, and the best set as
    paper_like.toml.

    The scene gives what is not searched: the pads' size and the platform. Stopped, the same command
    goes on with the next search.
    """

    def work() -> dict:
        from tipoff.studies.paper import stage

        return stage.run(study_of(scene, out, set_, workers=workers), stage.Options(starts))

    found = guarded(work, json_)
    if not json_:
        from tipoff.studies.paper import stage

        print("\n".join(stage.lines(found)))
