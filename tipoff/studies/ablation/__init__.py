"""Runs without each effect, one at a time: change of the result and of the time."""

from tipoff.studies.ablation import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.ablation import page, stage

    return Parts(stage.run, None, page.draw)


QUESTION = Question("ablation", "Runs without each effect", "Ablation", command.ablation, _load)
