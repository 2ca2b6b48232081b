"""Options of ``tipoff flight``."""

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from tipoff.studies.commands.options import Conditions, SeedOfFile, Surrogate, Vary
from tipoff.studies.commands.running import quantity

if TYPE_CHECKING:
    from tipoff.studies.commands.request import Request
    from tipoff.workspace.study import Study


@dataclass(frozen=True)
class Options:
    """``vary`` None: errors of the scene; ``cases`` and ``seed`` None: those of the file; ``model`` None:
    the default."""

    vary: Vary = None
    cases: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Number of cases; default: that of the file."),
    ] = None
    seed: SeedOfFile = None
    model: Surrogate = None


@dataclass(frozen=True)
class Asked:
    """All options of the command: conditions, values of the table ``[flight]``, and those of the
    study."""

    condition: Conditions = None
    range_: Annotated[
        str | None,
        typer.Option(
            "--range",
            metavar="LENGTH",
            help='Distance of the target along the launch axis, "500 m"; default: that of the scene.',
        ),
    ] = None
    altitude: Annotated[
        str | None, typer.Option(metavar="LENGTH", help='Altitude of the orbit, "500 km".')
    ] = None
    duration: Annotated[
        str | None, typer.Option(metavar="TIME", help='Duration of the flight, "2 hour".')
    ] = None
    options: Options = Options()

    def asked(self, request: "Request") -> "tuple[Study, Options]":
        """The study of a ``request``, and the options of its stage. Raises SceneError."""
        from tipoff.faults import together

        kinds = (
            ("range", self.range_, "m", "500 m"),
            ("altitude", self.altitude, "m", "500 km"),
            ("duration", self.duration, "s", "2 hour"),
        )
        together(*(partial(_require, *kind) for kind in kinds))
        table = [f"flight.{key}={value}" for key, value, *_ in kinds if value is not None]
        return request.study(self.condition, table), self.options


def _require(name: str, text: str | None, unit: str, example: str) -> None:
    """Raise SceneError if the option ``name`` is no quantity in ``unit``; "absent" removes the key."""
    if text != "absent":
        quantity(f"--{name}", text, unit, example)
