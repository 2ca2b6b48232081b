"""Options of ``tipoff view``."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import RefinedCondition


@dataclass(frozen=True)
class ViewOptions:
    """``condition`` None: the first refined one."""

    condition: RefinedCondition = None
    frames: Annotated[
        int,
        typer.Option(
            "--frames", metavar="N", min=2, help="Number of frames, evenly spread over the run."
        ),
    ] = 60


@dataclass(frozen=True)
class ViewCommand:
    """All options of the command: those of frames, and whether it shows the mesh instead."""

    options: ViewOptions = ViewOptions()
    mesh: Annotated[
        bool, typer.Option("--mesh", help="Show the mesh of the rails, without a run.")
    ] = False

    def require_mesh(self) -> None:
        """Raise SceneError for options of frames, which a mesh has none of."""
        from tipoff.faults import Fault, SceneError

        if self.options != ViewOptions():
            given = str(self.options.condition or self.options.frames)
            expected = "no --condition and no --frames with --mesh"
            raise SceneError([Fault("--mesh", "option", given, expected)])
