"""What searches for the paper's unpublished inputs show: ranges of every input, what the best set
leaves its rail with, data."""

from tipoff.studies.paper import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.paper import page, stage

    return Parts(stage.run, stage.stored, page.draw)


QUESTION = Question("paper", "The paper's own numbers", "Paper", command.add, _load)
