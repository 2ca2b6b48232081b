"""Error of the reference: quantities over refined meshes and steps, with their uncertainty."""

from tipoff.studies.convergence import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.convergence import page, stage

    return Contents(
        (Result("convergence", stage.run, stage.stored),),
        (Section("convergence", "Convergence", page.draw, "Error of the reference"),),
    )


ENTRY = Entry((command.convergence,), _load)
