"""Flight after separation: free rotation, relative motion in orbit, clearance of boxes."""

from tipoff.studies.flight import command
from tipoff.studies.question import Parts, Question


def _load() -> Parts:
    from tipoff.studies.flight import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("flight", "After separation", "Flight", command.flight, _load)
