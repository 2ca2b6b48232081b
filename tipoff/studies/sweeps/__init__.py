"""One error at a time over size and direction: where growth ends, which faces bear, whether the
thrust outlasts the rail."""

from tipoff.studies.question import Parts, Question
from tipoff.studies.sweeps import command


def _load() -> Parts:
    from tipoff.studies.sweeps import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("sweeps", "How large an error may be", "Sweeps", command.add, _load)
