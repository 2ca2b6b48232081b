"""Scene files from a few numbers, and their schema."""
