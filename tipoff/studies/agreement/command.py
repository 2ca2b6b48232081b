"""``tipoff compare``."""

from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands import common

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study
    from tipoff.studies.render.document import Part


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    common.add(
        app,
        "compare",
        "Agreement on fitted and held-out conditions with the floor, and the speed-up; writes "
        "agreement.json.",
        run,
        shown,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.agreement import stage

    return stage.run(study)


def shown(found: dict) -> list["Part"]:
    """The verdicts for the terminal."""
    from tipoff.studies.agreement import page

    return page.terminal(found)
