"""Every effect off, one at a time: what it changes and what it costs."""

from tipoff.studies.ablation import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.ablation import page, stage

    return Contents(
        (Result("ablation", stage.run),),
        (Section("ablation", "Ablation", page.draw),),
    )


ENTRY = Entry(command.add, _load)
