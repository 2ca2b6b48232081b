"""Run hard cases, each with a simpler method that fails on it; writes stability.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Hard cases", "Hard cases", always=True)
