"""``tipoff cost``."""

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
        "cost",
        "Error over wall time, and growth of time with elements, pads and effects; writes "
        "cost.json and cost_study.json.",
        run,
        shown,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.cost import stage

    return stage.run(study)


def shown(found: dict) -> "list[Part]":
    """What the terminal shows of it."""
    from tipoff.studies.cost import page

    return page.terminal(found)
