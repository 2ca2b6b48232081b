"""``tipoff view``."""

from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import RefinedCondition
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part


@scene_command(without=["workers"])
def view(
    request: Request,
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
            help="Factor of the deformation of the rail in pictures; default: one that makes the "
            "largest deformation visible.",
        ),
    ] = None,
) -> Output:
    """Show stress and motion of one condition; writes view/CONDITION/ with run.pvd, and pictures
    where pyvista is installed.

    Open run.pvd in ParaView. It shows undeformed rails and the payload in axes of the platform. To
    see the deformation of the rails, use "Warp By Vector" with the array "displacement (m)" and a
    scale factor of some hundreds. Colour by "von Mises stress (Pa)" or "contact pressure (Pa)".

      tipoff view --condition phi60 --frames 120
      tipoff view --scene my_launcher.toml --element-size 4 --exaggeration 500

    Pictures (peak.png, ejection.webp, and both for a dark page) need pyvista: pip install pyvista.
    The files for ParaView do not need it.
    """
    from tipoff.studies.view import page, stage

    def shown(found: dict) -> "list[Part]":
        files = [found["collection"], *found["pictures"].values()]
        lines = [f"  {request.out / found['scene'] / path}" for path in files]
        return [page.peak(found), "\n".join(lines)]

    return Output(stage.run(request.study(), condition, frames, exaggeration), shown)
