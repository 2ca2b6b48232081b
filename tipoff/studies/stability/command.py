"""``tipoff stability``."""

from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands import common

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study


def add(app: typer.Typer) -> None:
    """Add the command to ``app``."""
    common.add(
        app,
        "stability",
        "Hard cases, each with a simpler method that fails on it; writes stability.json.",
        run,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.stability import stage

    return stage.run(study)
