"""Comparison of two runs, and discretisation uncertainty from several meshes."""
