"""``tipoff sweeps``."""

from pathlib import Path
from typing import Annotated

import typer

from tipoff.studies.commands.asked import guarded, study_of
from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    SceneName,
    Set,
    Surrogate,
    Workers,
)


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    app.command()(sweeps)


def sweeps(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    angles: Annotated[
        int, typer.Option("--angles", metavar="N", help="Directions of each size.")
    ] = 120,
    model: Surrogate = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """How large misalignment, thrust and mass eccentricity may be: sizes up to 1 deg and 1 mm in
    every direction; writes sweeps.json.

    Says for the largest rate about each axis whether, and from which size on, it stops to grow,
    with the interval of that size; and shows the same launcher with a thrust that acts beyond the
    exit, or burns out before it.
    """

    def work() -> dict:
        from tipoff.studies.sweeps import stage

        study = study_of(scene, out, set_, element_size=element_size, workers=workers)
        return stage.run(study, stage.Options(angles, model and model.value))

    found = guarded(work, json_)
    if not json_:
        print("\n".join(found["summary"]))
