"""Contact of rigid pad faces with the surface of the rails."""
