"""Sweeps of errors by size and direction, a part of ``tipoff sensitivity``."""

from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.sensitivity.options import ANGLES
    from tipoff.studies.sweeps import page, stage

    title, again = "How large an error may be", f"sensitivity --sweep {ANGLES}"
    return Contents(
        (Result(stage.NAME, stage.run, stage.STAGE.stored),),
        (Section.of_stage(stage.STAGE, page.draw, stage.NAME, "Sweeps", title, again),),
    )


ENTRY = Entry((), _load)
