"""All studies that answer an engineer's question, in the order of their commands and of their
sections on the page."""

from tipoff.studies import (
    blind,
    droptest,
    flight,
    limits,
    montecarlo,
    paper,
    sensitivity,
    sweeps,
)
from tipoff.studies.question import Question

QUESTIONS: tuple[Question, ...] = (
    blind.QUESTION,
    sensitivity.QUESTION,
    sweeps.QUESTION,
    montecarlo.QUESTION,
    limits.QUESTION,
    flight.QUESTION,
    droptest.QUESTION,
    paper.QUESTION,
)
