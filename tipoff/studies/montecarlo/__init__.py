"""The random errors of the paper's Table 3 on the surrogate."""

from tipoff.studies.montecarlo import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.montecarlo import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("montecarlo", "Random errors", "Random errors", command.add, _load)
