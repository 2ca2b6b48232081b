"""Shared by both solvers: records, exit, trajectory, energy and momentum, rail compliance."""
