"""``tipoff sweeps``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    SceneName,
    Set,
    Surrogate,
    Workers,
)
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(sweeps)


def sweeps(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    angles: Annotated[
        int, typer.Option("--angles", metavar="N", help="Number of directions for each size.")
    ] = 120,
    model: Surrogate = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Rates by size and direction of misalignment, thrust eccentricity and mass eccentricity, up to
    1 deg and 1 mm; writes sweeps.json.

    The result states whether the largest rate about each axis stops growing, and the size at which
    it does, with its interval. The launcher is also run with a thrust that continues after the
    exit, or that ends before it.
    """

    def work() -> dict:
        from tipoff.studies.sweeps import stage

        study = study_of(scene, out, set_, element_size=element_size, workers=workers)
        return stage.run(study, stage.Options(angles, model and model.value))

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.sweeps import page

        return page.summary(found)

    guarded(work, json_, shown, out)
