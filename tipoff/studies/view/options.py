"""Options of ``tipoff view``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import RefinedCondition


@dataclass(frozen=True)
class Options:
    """``condition`` None: the first refined one."""

    condition: RefinedCondition = None
    frames: Annotated[
        int,
        typer.Option(
            "--frames", metavar="N", min=2, help="Number of frames, evenly spread over the run."
        ),
    ] = 60
