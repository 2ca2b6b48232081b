"""``tipoff recovery``."""

from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands import common

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Add the command to ``app``."""
    common.add(
        app,
        "recovery",
        "Whether calibration finds hidden values: 20 draws with 2 % of noise, and a reference with "
        "hidden clearance and friction; writes recovery.json.",
        run,
        shown,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.recovery import stage

    return stage.run(study)


def shown(found: dict) -> "list[Part]":
    """What the terminal shows of it."""
    from tipoff.studies.recovery import page

    return page.draw(found)
