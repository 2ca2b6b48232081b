"""Measure error over wall time; writes cost.json and cost_study.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Error over wall time", "Cost", always=True)
