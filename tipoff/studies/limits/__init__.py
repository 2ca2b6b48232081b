"""Find the largest tolerances of thrust, mass, clearance and friction for which the rates stay below
limits with a given probability; writes limits.json.

The result has each tolerance alone, all tolerances together, and pairs of misalignment and
mass eccentricity. It includes the uncertainty of the constants and of the model. With --vary, the
tolerances are those of a file of errors, as multiples of their scatter.

  tipoff limits --limit "x=2 deg/s" --limit "5 deg/s" --probability 0.99
  tipoff limits --limit "10 deg/s" --others zero --vary my_errors.toml
  tipoff limits --limit "10 deg/s" --probability 0.95 --certify 200
"""

from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Tolerances that keep limits", "Tolerances", LimitsOptions)
