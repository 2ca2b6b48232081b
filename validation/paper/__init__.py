"""The paper's unpublished inputs, inferred from its printed rates by searches."""

from tipoff.studies.question import Question
from validation.paper import command

QUESTION = Question(__name__, __doc__, "Comparison with the paper", "Paper", own=command.paper)
