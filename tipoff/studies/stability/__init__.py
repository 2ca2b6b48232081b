"""Run hard cases, each with a simpler method that fails on it; writes stability.json.

The cases have their own scenes. The scene only names the folder of the result.
"""

from tipoff.studies.question import Question

_UNUSED = "set_", "element_size", "workers", "strict"
QUESTION = Question(__name__, __doc__, "Hard cases", "Hard cases", always=True, without=_UNUSED)
