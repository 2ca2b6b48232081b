"""Hard cases, each with a simpler method that fails on it."""

from tipoff.studies.question import Parts, Question
from tipoff.studies.stability import command


def _load() -> Parts:
    from tipoff.studies.stability import page, stage

    return Parts(stage.run, None, page.draw)


QUESTION = Question("stability", "Hard cases", "Hard cases", command.stability, _load)
