"""Measure the ripple of a constant contact force as the pads cross the facets of the rails; writes
ripple.json."""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Ripple of a constant contact force", "Ripple")
