"""Flight after separation: free rotation, relative motion in orbit, clearance of boxes."""

from tipoff.studies.flight import command
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "After separation", "Flight", own=command.flight)
