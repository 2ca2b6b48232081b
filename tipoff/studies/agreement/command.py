"""``tipoff compare``."""

from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands import common

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    common.add(
        app,
        "compare",
        "Agreement on fitted and held-out conditions with the floor, and the speed-up; writes "
        "agreement.json.",
        run,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.agreement import stage

    return stage.run(study)
