"""Scene files: a new one from a few numbers, and the schema with which an editor completes them."""
