"""The largest tolerances that keep the rates below limits with a given probability."""

from tipoff.studies.limits import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.limits import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("limits", "Tolerances that keep limits", "Tolerances", command.limits, _load)
