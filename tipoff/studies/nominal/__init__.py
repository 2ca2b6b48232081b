"""The answer of the scene itself: its rates, and their range under its random errors."""

from tipoff.studies.question import Contents, Entry, Result


def _load() -> Contents:
    from tipoff.studies.nominal import stage

    return Contents((Result(stage.NAME, stage.run),))


ENTRY = Entry((), _load)
