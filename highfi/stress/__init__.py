"""Stress of the rails during a run."""
