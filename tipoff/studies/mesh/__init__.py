"""The mesh of the rails for the reference, a part of ``tipoff view``."""

from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.mesh import page, stage

    return Contents(
        (Result(stage.STAGE.name, stage.run),),
        (Section.of_stage(stage.STAGE, page.draw, "mesh", "Mesh", "Mesh", "view --mesh"),),
    )


ENTRY = Entry((), _load)
