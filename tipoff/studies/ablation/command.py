"""``tipoff ablation``."""

from typing import TYPE_CHECKING

import typer

from tipoff.studies.commands import common

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study


def add(app: typer.Typer) -> None:
    """Put the command under ``app``."""
    common.add(
        app,
        "ablation",
        "Every effect off, one at a time: time, rates, what is compiled; writes ablation.json.",
        run,
    )


def run(study: "Study") -> dict:
    """The result of the stage."""
    from tipoff.studies.ablation import stage

    return stage.run(study)
