"""Finite elements: the element, the operator, the stable step, and the meshes they are built on."""
