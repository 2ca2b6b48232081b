"""Measure error over wall time, and growth of time with elements, pads and effects; writes
cost.json and cost_study.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Error over wall time", "Cost", always=True)
