"""Mesh the rails for the reference; writes mesh.json (size, surfaces, quality) and mesh.vtu.

rail.inp is the first rail for CalculiX and Abaqus, with a load and the answers of tipoff in its
head: ccx rail.
"""

from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "Mesh", "Mesh", always=True, without=["workers"])
