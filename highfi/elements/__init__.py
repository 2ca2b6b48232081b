"""Finite elements of the rails: shape functions, stiffness, strain."""
