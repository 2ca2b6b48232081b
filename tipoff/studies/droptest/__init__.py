"""Drop tests: change of rate by the ejection, from logs, compared with a model."""

from tipoff.studies.droptest import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.droptest import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("droptest", "Drop tests", "Drop tests", command.droptest, _load)
