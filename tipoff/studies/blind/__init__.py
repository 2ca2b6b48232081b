"""Agreement on conditions drawn at random."""

from tipoff.studies.blind import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.blind import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("blind", "Agreement on blind conditions", "Blind", command.blind, _load)
