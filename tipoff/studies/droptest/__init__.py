"""Drop tests: from the log of an inertial unit to the change of rate by ejection, and what that
says of a model."""

from tipoff.studies.droptest import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.droptest import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("droptest", "Drop tests", "Drop tests", command.add, _load)
