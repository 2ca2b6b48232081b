"""Options of ``tipoff view``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import RefinedCondition


@dataclass(frozen=True)
class Options:
    """``condition`` None: the first refined one; ``exaggeration`` None: one that shows the largest
    deformation."""

    condition: RefinedCondition = None
    frames: Annotated[
        int,
        typer.Option(
            "--frames", metavar="N", min=2, help="Number of frames, evenly spread over the run."
        ),
    ] = 60
    exaggeration: Annotated[
        float | None,
        typer.Option(
            "--exaggeration",
            metavar="X",
            min=1e-6,
            help="Factor of the deformation of the rail in pictures; default: one that makes the "
            "largest deformation visible.",
        ),
    ] = None
