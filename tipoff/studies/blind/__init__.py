"""Compare the surrogates with the reference on random conditions, drawn after all constants are
fixed; writes blind.json.
"""

from tipoff.studies.blind.options import Options
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Agreement on blind conditions", "Blind", Options)
