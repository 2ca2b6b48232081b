"""Measure how the time of a run grows with elements, pads and effects, and with length of the rails,
cases and threads; writes scaling.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Growth of the run time", "Growth of time")
