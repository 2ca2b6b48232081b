"""A reading of the paper's Table 3, with its options on the command line."""

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

# Uncertainty, up and down: ground metal under light pressure, docs/interface_stiffness.md.
INTERFACE_FACTOR = 4.0


@dataclass(frozen=True)
class Reading:
    """``values`` and ``angles`` as in ``random_factors``; the ``rule`` of truncation; whether the
    ``initial`` position inside the clearance is random too; whether the ``interface`` stiffness is,
    with a uniform logarithm within a factor of ``INTERFACE_FACTOR``."""

    values: Annotated[
        Literal["signed", "half", "components"],
        typer.Option(
            "--reading",
            help="Axial value of an error: signed normal, its magnitude, or two normal components.",
        ),
    ] = "signed"
    angles: Annotated[
        Literal["independent", "shared"],
        typer.Option(help="One radial angle for each error, or one for all errors."),
    ] = "independent"
    rule: Annotated[
        Literal["redraw", "clip", "none"],
        typer.Option(help="Redraw, clip or keep a value beyond three sigma."),
    ] = "redraw"
    initial: Annotated[
        bool,
        typer.Option("--initial", help="Also draw the initial position, within the clearance."),
    ] = False
    interface: Annotated[
        bool,
        typer.Option(
            "--interface", help="Also draw the interface stiffness, within a factor of four."
        ),
    ] = False

    @property
    def words(self) -> str:
        """The reading as text."""
        what = {
            "signed": "signed normal",
            "half": "half normal",
            "components": "two normal components",
        }[self.values]
        where = (
            ""
            if self.values == "components"
            else {"independent": ", three angles", "shared": ", one angle"}[self.angles]
        )
        cut = {
            "redraw": "redrawn beyond 3 sigma",
            "clip": "clipped at 3 sigma",
            "none": "not truncated",
        }[self.rule]
        place = ", anywhere in the clearance" if self.initial else ""
        interface = ", any interface stiffness" if self.interface else ""
        return f"{what}{where}, {cut}{place}{interface}"

    @property
    def needs_contact(self) -> bool:
        """Whether the reading draws inputs that only a scene with contact has."""
        return self.initial or self.interface
