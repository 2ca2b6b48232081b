"""Which inputs an answer depends on: constants moved one at a time, and Sobol' indices."""

from tipoff.studies.question import Parts, Question
from tipoff.studies.sensitivity import command


def _load() -> Parts:
    from tipoff.studies.sensitivity import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question(
    "sensitivity", "Which numbers the answer depends on", "Sensitivity", command.add, _load
)
