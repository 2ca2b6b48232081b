"""Options of ``tipoff flight``."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import Conditions, Surrogate, Vary

if TYPE_CHECKING:
    from tipoff.studies.commands.request import Request
    from tipoff.workspace.study import Study


@dataclass(frozen=True)
class FlightOptions:
    """``vary`` None: errors of the scene; ``cases`` None: those of the file; ``model`` None:
    the default."""

    vary: Vary = None
    cases: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Number of cases; default: that of the file."),
    ] = None
    model: Surrogate = None


@dataclass(frozen=True)
class FlightCommand:
    """All options of the command: conditions, and those of the study."""

    condition: Conditions = None
    options: FlightOptions = FlightOptions()

    def asked(self, request: "Request") -> "tuple[Study, FlightOptions]":
        """The study of a ``request``, and the options of its stage. Raises SceneError."""
        return request.study(self.condition), self.options
