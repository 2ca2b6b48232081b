"""Explicit dynamics: forces, time steps, samples, exit, checkpoints."""
