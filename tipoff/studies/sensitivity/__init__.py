"""Sensitivity of the result to its inputs: one contact constant at a time, and Sobol' indices."""

from tipoff.studies.question import Parts, Question
from tipoff.studies.sensitivity import command


def _load() -> Parts:
    from tipoff.studies.sensitivity import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question(
    "sensitivity", "Sensitivity to uncertain inputs", "Sensitivity", command.sensitivity, _load
)
