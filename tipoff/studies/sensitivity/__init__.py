"""Compute the sensitivity to uncertain inputs: contact constants one at a time, and Sobol' indices;
writes sensitivity.json.

A file of tolerances gives the distribution of an input (vary), or of a factor of its nominal
value (factor):

  \\[factor."friction.dynamic"]
  distribution = "uniform"
  low = "0.75"
  high = "1.25"

  \\[vary."thrust_offset.misalignment.y"]      y and z are components of an offset
  distribution = "normal"
  mean = "0 deg"
  sd = "0.1 deg"
"""

from tipoff.studies.question import Question
from tipoff.studies.sensitivity.options import Options

QUESTION = Question(__name__, __doc__, "Sensitivity to uncertain inputs", "Sensitivity", Options)
