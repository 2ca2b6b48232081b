"""Equations of motion and their integration: steps, events, samples, exit."""
