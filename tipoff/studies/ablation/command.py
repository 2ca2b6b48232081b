"""``tipoff ablation``."""

from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands import common

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study


def add(app: typer.Typer) -> None:
    """Add the command to ``app``."""
    common.add(
        app,
        "ablation",
        "Run without each effect in turn: time, rates, compiled effects; writes ablation.json.",
        run,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.ablation import stage

    return stage.run(study)
