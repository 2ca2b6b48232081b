"""Options of ``tipoff montecarlo``."""

import math
from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.studies.commands.options import At, Surrogate, errors_file, rate_limits
from tipoff.studies.populations.reading import Reading

FEWEST_FINE = 4  # draws on the finer mesh
_SHARE_FINE = 0.1  # of the draws are on the finer mesh too


@dataclass(frozen=True)
class Cases:
    """``limits`` in the form of ``exceedance.limits``; ``vary`` None: the ``reading``; ``model`` and
    ``at`` None: the default."""

    cases: Annotated[int, typer.Option(metavar="N", min=100, help="Number of cases.")] = 1_000_000
    seed: Annotated[int, typer.Option("--seed", metavar="N", min=0, help="Seed of all draws.")] = 1
    vary: Annotated[str | None, errors_file("the reading of the paper's Table 3")] = None
    reading: Reading = Reading()
    limits: Annotated[
        tuple[str, ...],
        rate_limits(
            "2 deg/s",
            "The result is the probability above it. Default: 5 deg/s for each rate and for the total.",
        ),
    ] = ("x=5 deg/s", "y=5 deg/s", "z=5 deg/s", "5 deg/s")
    model: Surrogate = None
    at: At = None


@dataclass(frozen=True)
class MontecarloOptions:
    """``draws`` None: no run of the reference; ``fine`` None: a tenth of the draws, at least four."""

    population: Cases = Cases()
    draws: Annotated[
        int | None,
        typer.Option(
            "--reference",
            metavar="N",
            min=1,
            help="Also run the first N cases in the finite-element reference. It checks and corrects "
            "the statistics of all cases.",
        ),
    ] = None
    fine: Annotated[
        int | None,
        typer.Option(
            "--finer",
            metavar="N",
            min=1,
            help="Number of these cases that also run at half the element size; default: a tenth, at "
            "least 4.",
        ),
    ] = None

    @property
    def on_finer_mesh(self) -> int:
        """Number of draws on the finer mesh."""
        if self.fine is not None:
            return self.fine
        return max(FEWEST_FINE, math.ceil(_SHARE_FINE * (self.draws or 0)))
