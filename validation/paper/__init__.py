"""The paper's unpublished inputs, inferred from its printed rates by searches."""

from tipoff.studies.question import Parts, Question
from validation.paper import command


def _load() -> Parts:
    from validation.paper import page, stage

    return Parts(stage.run, stage.stored, page.draw)


QUESTION = Question("paper", "Comparison with the paper", "Paper", command.paper, _load)
