"""Options of ``tipoff sensitivity``: of the indices, and of the sweeps."""

from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import At, Surrogate, errors_file
from tipoff.workspace.options import Rule, between

HALVINGS = 3  # parts of the points, each half of the next, for convergence
_FEWEST = 2**HALVINGS * 8
ANGLES = 120  # directions of the sweeps of a report
FEWEST_ANGLES = 8  # smallest number of directions that separates the walls


@dataclass(frozen=True)
class SensitivityOptions:
    """``vary`` None: ``tolerances.DEFAULT``, or for sweeps every error up to 1 deg or mm; ``sweep`` None:
    ``ANGLES``, or none for ``tipoff sensitivity``; ``model`` and ``at`` None: the default."""

    vary: Annotated[
        str | None,
        errors_file(
            "studies/sensitivity/tolerances.toml; with --sweep each error up to 1 deg or 1 mm"
        ),
    ] = None
    sweep: Annotated[
        int | None,
        between(FEWEST_ANGLES),
        typer.Option(
            "--sweep",
            metavar="N",
            help="Vary the size of each error in N directions, in place of the indices; writes "
            f"sweeps.json. A report has {ANGLES} directions.",
        ),
    ] = None
    points: Annotated[
        int,
        Rule(
            lambda value: value >= _FEWEST and not int(value) & (int(value) - 1),
            f"a power of two, {_FEWEST} or more",
        ),
        typer.Option(
            metavar="N",
            help="Base points of the Sobol' indices, a power of two. Each base point needs two cases "
            "more than the number of inputs.",
        ),
    ] = 1024
    model: Surrogate = None
    at: At = None

    def require_one(self) -> None:
        """Raise SceneError for --points with --sweep, which has none."""
        from tipoff.faults import Fault, SceneError

        if self.sweep is not None and self.points != SensitivityOptions.points:
            raise SceneError([Fault("--points", "option", str(self.points), "none with --sweep")])
