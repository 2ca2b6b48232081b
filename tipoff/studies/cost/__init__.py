"""Wall time of the models, its growth, and the choice of a model for an accuracy or a time."""

from tipoff.studies.cost import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.cost import page, stage

    return Contents(
        (Result("cost_study", stage.run),),
        (Section("cost", "Cost", page.draw, "Error over wall time"),),
    )


ENTRY = Entry((command.cost,), _load)
