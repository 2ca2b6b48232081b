"""Speed of both solvers, each beside a plain program for the same task."""

from tipoff.studies.question import Contents, Entry, Result, Section
from validation.bench import command


def _load() -> Contents:
    from validation.bench import page, reference

    return Contents(
        (Result("bench", stored=lambda study: reference.stored(study.folder.parent)),),
        (Section("bench", "Solvers", page.draw, "Speed of the solvers"),),
    )


ENTRY = Entry((command.bench, command.waits, command.ladder, command.cells), _load)
