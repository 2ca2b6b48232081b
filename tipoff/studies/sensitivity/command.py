"""``tipoff sensitivity``."""

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
    app.command()(sensitivity)


def sensitivity(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    vary: Annotated[
        Path | None,
        typer.Option(
            "--vary",
            metavar="FILE",
            help="Distributions of the uncertain inputs, a .toml file; default: "
            "studies/sensitivity/tolerances.toml.",
        ),
    ] = None,
    points: Annotated[
        int,
        typer.Option(
            "--points",
            metavar="N",
            help="Base points of the Sobol' indices, a power of two; each base point takes two "
            "cases more than there are inputs.",
        ),
    ] = 1024,
    seed: Annotated[
        int, typer.Option("--seed", metavar="N", help="Seed of the points and of the bootstrap.")
    ] = 1,
    model: Surrogate = None,
    element_size: ElementSize = None,
    workers: Workers = None,
    json_: Json = False,
) -> None:
    """Sensitivity of the result to uncertain inputs: contact constants as in the paper's Table 2,
    and Sobol' indices; writes sensitivity.json.

    A file of tolerances gives the distribution of an input (vary), or of a factor of its nominal
    value (factor):

      \\[factor."friction.dynamic"]
      distribution = "uniform"
      low = "0.75"
      high = "1.25"

      \\[vary."thrust_offset.misalignment.y"]      y and z are components of an offset
      distribution = "normal"
      mean = "0 deg"
      sd = "0.1 deg"
    """

    def work() -> dict:
        from tipoff.studies.sensitivity import stage

        study = study_of(scene, out, set_, element_size=element_size, workers=workers)
        tolerances = None if vary is None else str(vary)
        return stage.run(study, stage.Options(tolerances, points, seed, model and model.value))

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.sensitivity import page

        return page.summary(found)

    guarded(work, json_, shown, out)
