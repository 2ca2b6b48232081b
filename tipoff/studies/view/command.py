"""``tipoff view``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    RefinedCondition,
    SceneName,
    Set,
)
from tipoff.studies.commands.running import guarded, study_of

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Add the command to ``app``."""
    app.command()(view)


def view(
    scene: SceneName = "reference",
    out: Out = Path("out"),
    set_: Set = None,
    condition: RefinedCondition = None,
    frames: Annotated[
        int,
        typer.Option(
            "--frames", metavar="N", min=2, help="Number of frames, evenly spread over the run."
        ),
    ] = 60,
    exaggeration: Annotated[
        float | None,
        typer.Option(
            "--exaggeration",
            metavar="X",
            min=1e-6,
            help="Factor of the deformation of the rail in pictures; default: chosen by its size.",
        ),
    ] = None,
    element_size: ElementSize = None,
    json_: Json = False,
) -> None:
    """Show stress and motion of one condition; writes view/CONDITION/ with run.pvd, and pictures
    where pyvista is installed.

    Open run.pvd in ParaView. It shows rails and payload, seen from the platform and undeformed. To
    see the deformation of the rails, use "Warp By Vector" with the array "displacement (m)" and a
    scale factor of some hundreds. Colour by "von Mises stress (Pa)" or "contact pressure (Pa)".

      tipoff view --condition phi60 --frames 120
      tipoff view --scene my_launcher.toml --element-size 4 --exaggeration 500

    Pictures (peak.png, ejection.webp, and both for a dark page) need pyvista: pip install pyvista.
    The files for ParaView do not.
    """

    def work() -> dict:
        from tipoff.studies.view import stage

        return stage.run(
            study_of(scene, out, set_, element_size=element_size), condition, frames, exaggeration
        )

    def shown(found: dict) -> list["Part"]:
        from tipoff.studies.view import page

        folder = Path(out) / found["scene"]
        files = [found["collection"], *found["pictures"].values()]
        return [page.peak(found), "\n".join(f"  {folder / path}" for path in files)]

    guarded(work, json_, shown)
