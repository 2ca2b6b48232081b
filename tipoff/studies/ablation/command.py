"""``tipoff ablation``."""

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
        "ablation",
        "Run without each effect in turn: time, rates, compiled effects; writes ablation.json.",
        run,
        shown,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.ablation import stage

    return stage.run(study)


def shown(found: dict) -> "list[Part]":
    """What the terminal shows of it."""
    from tipoff.studies.ablation import page

    return page.terminal(found)
