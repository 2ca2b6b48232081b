"""Meshes as data: gmsh geometry, and the small .msh files that tests read."""
