"""The command of a stage that takes the common options only."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands.options import ElementSize, Json, Out, SceneName, Set, Workers
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study
    from tipoff.studies.render.document import Part


def add(
    app: typer.Typer,
    name: str,
    summary: str,
    run: Callable[["Study"], dict],
    shown: Callable[[dict], list["Part"]],
) -> None:
    """Add a command to ``app``: its ``name``, its help ``summary``, the function it runs, and what
    of the result is ``shown`` in the terminal."""

    def command(
        scene: SceneName = "reference",
        out: Out = Path("out"),
        set_: Set = None,
        element_size: ElementSize = None,
        workers: Workers = None,
        json_: Json = False,
    ) -> None:
        guarded(
            lambda: run(study_of(scene, out, set_, element_size=element_size, workers=workers)),
            json_,
            shown,
            out,
        )

    app.command(name, help=summary)(command)
