"""Meshes of rails, one file for each format. ``reader`` is the entry."""
