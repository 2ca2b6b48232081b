"""Speed of both solvers against what one would write today."""

from tipoff.studies.bench import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.bench import page, reference

    return Contents(
        (Result("bench", stored=lambda study: reference.stored(study.folder.parent)),),
        (Section("bench", "Solvers", page.draw),),
    )


ENTRY = Entry(command.add, _load)
