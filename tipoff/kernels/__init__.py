"""Basis of all compiled kernels: compilation, aligned arrays, rotations."""
