"""Estimate the error of the reference from mesh, step, interface stiffness and contact cells;
takes minutes; writes convergence.json."""

from tipoff.studies.convergence.options import ConvergenceOptions
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Error of the reference", "Convergence", ConvergenceOptions)
