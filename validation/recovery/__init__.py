"""Test whether calibration finds hidden values: 20 draws with 2 % of noise, and a reference
with hidden clearance and friction; writes recovery.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Whether calibration finds hidden values", "Recovery")
