"""Run hard cases, each with a simpler method that fails on it; writes stability.json.

The cases have scenes and elements of their own; the scene only names the folder of the result.
"""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Hard cases", "Hard cases", always=True)
