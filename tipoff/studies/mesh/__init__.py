"""The mesh of the rails for the reference."""

from tipoff.studies.mesh import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.mesh import page, stage

    return Contents(
        (Result("mesh", stage.run),),
        (Section("mesh", "Mesh", page.draw, "Mesh"),),
    )


ENTRY = Entry((command.mesh,), _load)
