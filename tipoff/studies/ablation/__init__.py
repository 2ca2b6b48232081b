"""Run without one effect at a time: time, rates, effects evaluated; writes ablation.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Runs without each effect", "Ablation", always=True)
