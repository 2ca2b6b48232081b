"""One error at a time over size and direction: the end of growth, the loaded faces, and the thrust
after the exit."""

from tipoff.studies.question import Parts, Question
from tipoff.studies.sweeps import command


def _load() -> Parts:
    from tipoff.studies.sweeps import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("sweeps", "How large an error may be", "Sweeps", command.sweeps, _load)
