"""Mesh of a scene's rails, its check against the scene, and the memory check."""
