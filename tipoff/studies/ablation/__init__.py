"""Runs without each effect, one at a time: change of the result and of the time."""

from tipoff.studies.ablation import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.ablation import page, stage

    return Contents(
        (Result("ablation", stage.run),),
        (Section("ablation", "Ablation", page.draw, "Runs without each effect"),),
    )


ENTRY = Entry((command.ablation,), _load)
