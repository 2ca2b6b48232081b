"""Recovery of hidden values by calibration: from noisy curves of the surrogate and from the
reference."""

from tipoff.studies.question import Parts, Question
from validation.recovery import command


def _load() -> Parts:
    from validation.recovery import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question(
    "recovery", "Whether calibration finds hidden values", "Recovery", command.recovery, _load
)
