"""Hard cases, each with a simpler method that fails on it."""

from tipoff.studies.question import Contents, Entry, Result, Section
from tipoff.studies.stability import command


def _load() -> Contents:
    from tipoff.studies.stability import page, stage

    return Contents(
        (Result("stability", stage.run),),
        (Section("stability", "Hard cases", page.draw, "Hard cases"),),
    )


ENTRY = Entry((command.stability,), _load)
